// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/ddm/pencil_end.hpp>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

constexpr double lanczos_reduction = 1e-2;  // of 1/(lambda - sigma), per shift

class EndSearch {
 public:
  EndSearch(const ShiftedPencilFamily& family, const InterfaceOperator& p, const PencilPoint& point,
            SpectrumEnd end, const EndOptions& options)
      : family_(family), p_(p), point_(point), end_(end), options_(options) {}

  PencilEnd run(const std::optional<EndGuess>& guess, Vector start) {
    double shift = first_shift(guess);
    while (result_.factorisations < options_.maximum_factorisations) {
      std::optional<ShiftedPencil> pencil = factorise(shift);
      if (!pencil) break;
      if (beyond(*pencil) < 0) {  // among the eigenvalues of the kernel
        outer_ = pencil->shift();
        shift = inner_ > *outer_ ? std::sqrt(inner_ * *outer_) : 16 * *outer_;  // eigenvalues span decades
        continue;
      }
      if (beyond(*pencil) > 0) {
        inner_ = pencil->shift();
        shift = step_out(inner_);
        continue;
      }
      if (!outer_ || inward(pencil->shift() - *outer_) > 0) outer_ = pencil->shift();
      if (!lanczos(*pencil, start, 1)) break;
      start = result_.vectors.col(0);
      if (result_.residual <= tolerance()) {
        result_.converged = true;
        if (!options_.certify || certify()) {
          if (options_.eigenvalues > 1) list(start);
          break;
        }
        shift = step_out(inner_);  // a closer one lies beyond what was found
        result_.converged = false;
        continue;
      }
      shift = closer_shift();
    }
    return result_;
  }

 private:
  // Signed so that inwards is positive at both ends.
  double inward(double difference) const { return end_ == SpectrumEnd::smallest ? difference : -difference; }

  // Of lambda here: relative where |1 - lambda|, an eigenvalue of B, is above 1.
  double tolerance() const {
    return options_.tolerance *
           (result_.values.size() > 0 ? std::max(1.0, std::abs(1 - result_.values[0])) : 1.0);
  }

  double first_shift(const std::optional<EndGuess>& guess) const {
    const double beyond_bound =
        end_ == SpectrumEnd::smallest ? point_.low * (1 - 1e-3) : point_.high * (1 + 1e-3);
    if (guess) {
      const double shift = guess->value - inward(2 * guess->uncertainty + 10 * options_.tolerance);
      if (shift > 0 && inward(shift - beyond_bound) > 0) return shift;
    }
    if (end_ == SpectrumEnd::smallest) return beyond_bound > 0 ? beyond_bound : 0.1;
    return std::isfinite(beyond_bound) ? beyond_bound : 1 + 1e-3;
  }

  // Further out than a shift that has eigenvalues beyond it.
  double step_out(double shift) const {
    if (outer_) return std::sqrt(shift * *outer_);
    return end_ == SpectrumEnd::smallest ? shift / 16 : shift * 4;
  }

  // `side`: where to step, inwards (1) or outwards (-1), from a shift that will not do.
  std::optional<ShiftedPencil> factorise(double shift, double side = -1) {
    for (int attempt = 0; attempt < 5; ++attempt) {
      ++result_.factorisations;
      ShiftedPencil pencil = family_.at(point_.epsilon, point_.eta, shift);
      if (pencil.reliable()) return pencil;
      // Near enough to serve, far enough to leave the accident that spoilt this one.
      const double step = std::max(0.3 * tolerance(), 1e-9 * shift) * std::pow(10.0, attempt);
      shift = std::max(shift + side * inward(step), 0.5 * shift);
    }
    return std::nullopt;
  }

  Index beyond(const ShiftedPencil& pencil) const {
    return end_ == SpectrumEnd::smallest ? pencil.below() - point_.kernel : p_.rows() - pencil.below();
  }

  bool lanczos(const ShiftedPencil& pencil, const Vector& start, Index wanted) {
    const double shift = pencil.shift();
    // Relative to 1/(lambda - sigma): the distance is known from earlier rounds, or one is left to come.
    ArpackOptions arpack = options_.arpack;
    arpack.tolerance = lanczos_reduction;
    if (result_.values.size() > 0)
      arpack.tolerance = std::max(lanczos_reduction, 0.3 * tolerance() / std::abs(result_.values[0] - shift));
    // A list is asked for once its first value is known: the others lie within about 1 of the shift.
    if (wanted > 1) arpack.tolerance = 0.1 * options_.tolerance;
    arpack.basis = std::max(arpack.basis, 2 * wanted + 8);
    const LinearMap p = [this](const Vector& x) -> Vector { return p_.apply(x); };
    const LinearMap solve = [&](const Vector& x) -> Vector { return ++result_.solves, pencil.solve(x); };
    ShiftInvertResult found = shift_invert_lanczos(p_.rows(), solve, p, shift, end_, wanted, arpack, start);
    if (found.values.size() == 0) return false;
    double residual = 0;
    for (Index k = 0; k < found.values.size(); ++k) {
      const Vector x = found.vectors.col(k);
      const Vector px = p(x), y = solve(px);
      const double norm = x.dot(px), nu = y.dot(px) / norm;  // Rayleigh quotient of (S - sigma P)^-1 P
      const Vector r = y - nu * x;
      const double bound = std::sqrt(std::max(0.0, r.dot(p(r))) / norm);
      found.values[k] = shift + 1 / nu;
      const double safe = std::abs(nu) - bound;  // |1/nu - 1/nu*| for |nu - nu*| <= bound
      residual = std::max(residual, (safe > 0 ? bound / (std::abs(nu) * safe) : infinity) +
                                        pencil.solution_error() / std::abs(nu));
    }
    result_.values = found.values;
    result_.vectors = found.vectors;
    result_.residual = found.converged ? residual : std::max(residual, 2 * tolerance());
    return true;
  }

  // The eigenvalues next to the end, from a shift far enough to see them all.
  void list(const Vector& start) {
    const Index wanted = std::min(options_.eigenvalues, p_.rows() - 2);
    const double value = result_.values[0];
    const std::optional<ShiftedPencil> pencil = factorise(value - inward(1e-3 * value));
    const PencilEnd first = result_;
    if (pencil && lanczos(*pencil, start, wanted) && result_.values.size() == wanted) {
      result_.converged = result_.residual <= tolerance();
    } else {
      result_.values = first.values;
      result_.vectors = first.vectors;
      result_.converged = false;
    }
  }

  double closer_shift() const {
    const double value = result_.values[0];
    const double step = std::max(2 * result_.residual, 2 * tolerance());
    const double shift = value - inward(step);
    // Never further out than what is proved already.
    return outer_ && inward(shift - *outer_) <= 0 ? value - inward(0.3 * std::abs(value - *outer_)) : shift;
  }

  // Counts just outside and just inside; false where an eigenvalue beyond the first was missed.
  bool certify() {
    const double value = result_.values[0];
    const double margin =
        std::max({tolerance(), 2 * result_.residual, 4 * point_.rounding * std::max(1.0, std::abs(value))});
    const std::optional<ShiftedPencil> out = factorise(std::max(value - inward(margin), 0.5 * value));
    const std::optional<ShiftedPencil> in = factorise(value + inward(margin), 1);
    if (!out || !in) return true;  // converged, not certified
    if (beyond(*out) > 0) {
      inner_ = out->shift();
      return false;
    }
    result_.outside = out->shift();
    result_.inside = in->shift();
    result_.within = beyond(*in);
    result_.certified = result_.within > 0;
    return true;
  }

  const ShiftedPencilFamily& family_;
  const InterfaceOperator& p_;
  const PencilPoint& point_;
  SpectrumEnd end_;
  const EndOptions& options_;
  PencilEnd result_;
  std::optional<double> outer_;  // innermost shift with no eigenvalue beyond it
  double inner_ = 0;             // last shift with one
};

}  // namespace

PencilEnd find_end(const ShiftedPencilFamily& family, const InterfaceOperator& preconditioner,
                   const PencilPoint& point, SpectrumEnd end, const std::optional<EndGuess>& guess,
                   const Vector& start, const EndOptions& options) {
  return EndSearch(family, preconditioner, point, end, options).run(guess, start);
}

}  // namespace nscdd
