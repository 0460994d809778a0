// SPDX-License-Identifier: GPL-3.0-or-later
#include "spectra/pencil_end.hpp"

namespace nscdd {
namespace {

constexpr double share_of_margin = 0.2;  // accepted error of Lanczos over the distance of the last shift
constexpr Index few = 16;                // eigenvalues beyond a shift that are searched from it
constexpr Index most_reaches = 6;        // then the search restarts from further out

class EndSearch {
 public:
  explicit EndSearch(PencilSide& side) : side_(side) {}

  void run(const std::optional<EndGuess>& guess, Vector start) {
    double shift = first_shift(guess), last_distance = infinity;
    while (result_.factorisations < options_.maximum_factorisations) {
      const std::optional<ShiftedPencil> pencil = side_.factorise(shift);
      if (!pencil) break;
      if (beyond(*pencil) < 0) {  // the shift lies among the eigenvalues of the kernel
        outer_ = pencil->shift();
        shift = inner_ > *outer_ ? std::sqrt(inner_ * *outer_) : 16 * *outer_;  // they span decades
        continue;
      }
      if (beyond(*pencil) > 0) {
        inner_ = pencil->shift();
        shift = reach_out(*pencil) ? closer_shift() : step_out(inner_);
        start = {};  // the vector it came from has missed the end
        continue;
      }
      if (!outer_ || inward(pencil->shift() - *outer_) > 0) outer_ = pencil->shift();
      if (found() && distance_to_proof() <= tolerance()) {
        complete(*pencil);
      } else {
        if (!close_in(*pencil, start)) break;
        start = result_.vectors.col(0);
      }
      if (converged()) {
        if (bound_ > tolerance()) sharpen(*pencil);
        if (!sloped_) measure_slopes(*pencil);
        break;
      }
      if (quotient_ && distance_to_proof() > 0.9 * last_distance)
        break;  // no factorisation nearer to the end is reliable
      last_distance = distance_to_proof();
      shift = closer_shift();
    }
    if (!found() || !converged()) return;
    if (options_.certify) certify();
    if (options_.eigenvalues > 1) side_.list_behind();
  }

 private:
  bool found() const { return result_.values.size() > 0; }
  double value() const { return result_.values[0]; }

  double inward(double difference) const { return side_.inward(difference); }
  double tolerance() const { return side_.tolerance(value()); }
  double margin(double lambda) const { return side_.margin(lambda); }
  Index beyond(const ShiftedPencil& pencil) const { return side_.beyond(pencil); }

  // Proved bound of the spectrum, by a count or known beforehand; infinite without any.
  double proved() const {
    const double known = smallest_ ? point_.low : point_.high;
    if (point_.kernel > 0 && smallest_) return outer_.value_or(-infinity);
    return outer_ && inward(*outer_ - known) > 0 ? *outer_ : known;
  }
  double distance_to_proof() const { return std::max(0.0, inward(value() - proved())); }

  bool converged() {
    result_.residual = quotient_ ? distance_to_proof() + solution_error_ : infinity;
    return result_.converged = result_.residual <= tolerance();
  }

  double first_shift(const std::optional<EndGuess>& guess) {
    if (guess) {
      guess_ = guess->value;
      distance_ = 2 * guess->uncertainty + 10 * options_.tolerance;
      return beyond_guess();
    }
    if (smallest_) return point_.low > 0 ? point_.low * (1 - 1e-3) : 0.1;
    return std::isfinite(point_.high) ? point_.high * (1 + 1e-3) : 1 + 1e-3;
  }

  double beyond_guess() const {
    if (!smallest_) return std::min(guess_ + distance_, point_.high * (1 + 1e-3));
    return std::max(guess_ / (1 + distance_ / guess_), point_.low * (1 - 1e-3));  // always positive
  }

  // A shift further out than one that has eigenvalues beyond it. It clears the bound of a known value, within which
  // near-copies lie. Otherwise it is halfway to the proved bound, on a logarithmic scale.
  double step_out(double shift) {
    if (found()) {
      const double clear = value() - inward(4 * (bound_ + solution_error_));
      if (inward(shift - clear) > 0 && inward(clear - proved()) > 0) return clear;
    }
    if (proved() > 0 && std::isfinite(proved())) return std::sqrt(shift * proved());
    const double far = smallest_ ? shift / 16 : shift * 4;
    if (guess_ == 0) return far;
    distance_ *= 8;
    return inward(beyond_guess() - shift) < 0 ? beyond_guess() : far;
  }

  // Eigenvalue k of a run becomes the first value, unless a value clearly further out is known.
  void take(const ShiftInvertResult& run, Index k, const ShiftedPencil& pencil) {
    const double doubt = 2 * solution_error_ + (found() ? margin(value()) : 0);
    if (quotient_ && inward(run.values[k] - value()) > doubt) return;
    result_.values = run.values.segment(k, 1);
    result_.vectors = run.vectors.col(k);
    bound_ = run.bounds[k];
    error_ = run.errors[k];
    solution_error_ = pencil.solution_error() * std::abs(value() - pencil.shift());
  }

  ShiftInvertOptions accuracy_at(double lambda) const {
    return {.maximum_steps = options_.steps, .accuracy = share_of_margin * margin(lambda)};
  }

  // Searches for the end from a shift beyond it; false if nothing was found.
  bool close_in(const ShiftedPencil& pencil, const Vector& start) {
    const ShiftInvertResult run = side_.lanczos(pencil, side_.end, 1, accuracy_at(pencil.shift()), start);
    if (run.values.size() == 0) return false;
    take(run, 0, pencil);
    quotient_ = true;
    return true;
  }

  // The error of a value is of second order, that of its vector of first: iterates until the vector is as good.
  void sharpen(const ShiftedPencil& pencil) {
    const double relative = 0.5 * tolerance() / std::abs(value() - pencil.shift());
    const Vector start = result_.vectors.col(0);
    const ShiftInvertResult run =
        side_.lanczos(pencil, side_.end, 1, {.maximum_steps = 2 * options_.steps, .tolerance = relative}, start);
    if (run.values.size() > 0) take(run, 0, pencil);
  }

  // Searches for the end from a shift with a few eigenvalues beyond it, the last of which is the end.
  bool reach_out(const ShiftedPencil& pencil) {
    const Index wanted = beyond(pencil);
    const bool kernel = smallest_ && point_.kernel > 0;  // the kernel lies beyond as well
    if (kernel || wanted > few || ++reached_out_ > most_reaches) return false;
    const SpectrumEnd outwards = smallest_ ? SpectrumEnd::largest : SpectrumEnd::smallest;
    const ShiftInvertResult run = side_.lanczos(pencil, outwards, wanted, accuracy_at(pencil.shift()), {});
    const Index last = run.values.size() - 1;
    if (last + 1 < wanted || !(run.values[last] > 0)) return false;
    if (outer_ && inward(run.values[last] - *outer_) <= 0) return false;
    quotient_ = false;  // from this side Ritz values may lie beyond the end
    take(run, last, pencil);
    return true;
  }

  // Inverse iteration from a shift next to the value: with (S - sigma P) y = P x the Rayleigh quotient of y
  // is sigma + delta, delta = x'Py / y'Py, and ||x - delta y||_P / ||y||_P its residual.
  void complete(const ShiftedPencil& pencil) {
    Vector x = result_.vectors.col(0);
    for (int k = 0; k < 3; ++k) {
      const Vector px = side_.apply(x);
      const ShiftedPencil::Response response = side_.respond(pencil, x, px);
      const Vector &y = response.f, py = side_.apply(y);
      const double norm = y.dot(py), delta = x.dot(py) / norm;
      const double residual = std::sqrt(std::max(0.0, (x - delta * y).dot(px - delta * py)) / norm);
      if (!std::isfinite(residual)) return;
      x = y / std::sqrt(norm);
      result_.values[0] = pencil.shift() + delta;
      result_.vectors.col(0) = x;
      set_slopes(response, norm);
      solution_error_ = pencil.solution_error() * std::abs(delta);
      bound_ = error_ = residual;
      quotient_ = true;
      if (residual <= 0.1 * tolerance()) return;
    }
  }

  void measure_slopes(const ShiftedPencil& pencil) {
    const Vector x = result_.vectors.col(0);
    const ShiftedPencil::Response response = side_.respond(pencil, x, side_.apply(x));
    set_slopes(response, response.f.dot(side_.apply(response.f)));
  }

  void set_slopes(const ShiftedPencil::Response& response, double norm) {
    result_.slope_epsilon = (point_.without == nullptr ? 1 : 1 - value()) * response.system / norm;
    result_.slope_eta = -value() * response.preconditioner / norm;
    sloped_ = true;
  }

  // The next shift: a tenth of the tolerance beyond the value or, if its error may be larger, beyond its bound.
  double closer_shift() const {
    const double beyond_value = margin(value());
    if (error_ + solution_error_ <= 2 * share_of_margin * beyond_value)
      return std::max(value() - inward(beyond_value), 0.5 * value());
    const double step = std::max(2 * (bound_ + solution_error_), beyond_value);
    // Never further out than the proved bound.
    return std::max(value() - inward(std::min(step, 0.3 * distance_to_proof())), 0.5 * value());
  }

  // A count just outside proves the end (the last shift may serve), one just inside gives its multiplicity.
  void certify() {
    const double keep_away = std::max(tolerance(), 4 * side_.rounding(value()));
    const double distance = outer_ ? std::abs(value() - *outer_) : infinity;
    if (distance < 2 * side_.rounding(value()) || distance > keep_away) {
      const std::optional<ShiftedPencil> out = side_.factorise(value() - inward(keep_away));
      if (!out || beyond(*out) != 0) return;
      outer_ = out->shift();
    }
    const std::optional<ShiftedPencil> in = side_.factorise(value() + inward(keep_away), 1);
    if (!in) return;
    result_.outside = *outer_;
    result_.inside = in->shift();
    result_.within = beyond(*in);
    result_.certified = result_.within > 0;
  }

  PencilSide& side_;
  PencilEnd& result_ = side_.result;
  const PencilPoint& point_ = side_.point;
  const EndOptions& options_ = side_.options;
  const bool smallest_ = side_.end == SpectrumEnd::smallest;
  std::optional<double> outer_;  // innermost shift without an eigenvalue beyond it
  double inner_ = 0;             // last shift with eigenvalues beyond it
  Index reached_out_ = 0;
  double guess_ = 0, distance_ = 0;             // the expected end, and the first shift's distance beyond it
  double bound_ = infinity, error_ = infinity;  // proved bound and estimate of the error of the value, by Lanczos
  double solution_error_ = 0;
  bool sloped_ = false;    // the slopes are known
  bool quotient_ = false;  // the value is a Rayleigh quotient of (S, P), never beyond the end
};

}  // namespace

PencilEnd find_end(const ShiftedPencilFamily& family, const InterfaceOperator& preconditioner, const PencilPoint& point,
                   SpectrumEnd end, const std::optional<EndGuess>& guess, const Vector& start,
                   const EndOptions& options) {
  PencilSide side{family, preconditioner, point, end, options};
  EndSearch(side).run(guess, start);
  return std::move(side.result);
}

}  // namespace nscdd
