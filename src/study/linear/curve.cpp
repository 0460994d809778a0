// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/curve.hpp"

#include "core/fail.hpp"
#include "ddm/enriched_inertia.hpp"
#include "spectra/spectrum_memory.hpp"
#include "study/linear/sweep_points.hpp"
#include "study/linear/values.hpp"

namespace nscdd {
namespace {

struct Known {
  SweepResult result;
  CurvePoint point = {};
  std::optional<PencilMemory::Visited> ends = {};  // from which those of neighbours are interpolated
};

// Data of all curves of a table.
struct Work {
  const CurveParameters& parameters;
  Selection selection;
  double scale;
  const Model& model;
  std::optional<Decomposition> whole;  // of the scheme schwarz
  InterfaceFamily stage_two, stage_one;
  SpectralOptions options;
  SpectrumMemory memory = {};

  Work(const Model& given, const CurveParameters& asked)
      : parameters(asked),
        selection(select(given, asked.sweep.contacts)),
        scale(flexibility_scale(given)),
        model(given),
        whole(asked.sweep.schwarz() ? std::optional(whole_masses(selection.stage_one(given))) : std::nullopt),
        stage_two(whole ? *whole : given.parts),
        stage_one(selection.restricted && !whole ? InterfaceFamily(*selection.restricted) : stage_two),
        options(asked.sweep.spectral) {
    // The certificate of a dense spectrum costs nothing and bounds the rounding of its ends.
    const Index size = (whole ? *whole : given.parts).interface_size();
    options.certify |= choose_solver(size, options).solver == SpectralSolver::dense;
  }

  bool along_epsilon() const { return parameters.axis == CurveAxis::epsilon; }
};

// x with six digits, for readers of tables; x itself if the ends are too near.
double with_six_digits(double x, double from, double to) {
  const double rounded = std::stod(fmt::format("{:.5e}", x));
  return std::abs(rounded - x) < 0.1 * std::min(x - from, to - x) ? rounded : x;
}

// A curve: its points in ascending order and the deviations between neighbours.
class Curve {
 public:
  Curve(Work& work, const SweepPoint& start) : work_(work), start_(start) {
    const SweepParameters& sweep = work.parameters.sweep;
    const std::vector<double>& range = work.along_epsilon() ? sweep.epsilon : sweep.eta;
    const Decomposition& parts = work.along_epsilon() ? work.selection.stage_one(work.model) : work.model.parts;
    const auto q = static_cast<double>(work.whole ? largest_multiplicity(work.whole->interface) : 1);  // W <= q D
    const double bound = q * stiffest(work.whole ? *work.whole : parts);
    law_ = {work.parameters.axis, bound * (1 + 1e-12), *start.relaxation, sweep.schwarz()};
    for (const double x : {range.front(), range.back()}) add(x, count(points_));
  }

  CurveReport trace(const Monitor& monitor, Index before) {
    while (true) {
      if (!converged_) return report_as(CurveStatus::not_converged);
      const std::optional<Index> worst = worst_row();
      const bool done = !worst || count(points_) >= work_.parameters.most_points;
      if (!report(monitor, before + count(points_), before + count(points_) + (done ? 0 : expected())))
        return report_as(CurveStatus::stopped);
      if (done) return report_as(proved() ? CurveStatus::proved : CurveStatus::wide);
      const Index k = widest_beside(*worst);
      const double x = place(k, *worst);
      if (!(x > asked(k) && x < asked(k + 1))) return report_as(CurveStatus::wide);  // adjacent doubles
      add(x, k + 1);
    }
  }

  void hand_over(const Sink<CurveResult>& sink) const {
    for (Index row = 0; row < count(points_); ++row) {
      CurveResult result{points_[at(row)].result};
      if (converged_) {
        result.low = result.found.radius.subdominant - below(row);
        result.high = result.found.radius.subdominant + above(row);
      }
      sink(result);
    }
  }

 private:
  double asked(Index k) const {
    const SweepPoint& point = points_[at(k)].result.asked;
    return work_.along_epsilon() ? point.epsilon : point.eta;
  }

  // Computes the point at x, in the unit of the range, and inserts it at this position.
  void add(double x, Index position) {
    SweepPoint point = start_;
    (work_.along_epsilon() ? point.epsilon : point.eta) = x;
    Known known{
        {work_.selection.of_case, at_scale(point, work_.parameters.sweep, work_.scale), {}, {}, point, work_.scale}};
    compute(known, position);
    converged_ &= known.result.radius.converged;
    if (failure_.empty()) failure_ = known.result.radius.failure;
    points_.insert(points_.begin() + position, std::move(known));
    update(position);
  }

  void compute(Known& known, Index position) {
    SweepResult& result = known.result;
    const Contraction b{work_.stage_two.at(result.point.eta), work_.stage_one.at(result.point.epsilon), 1,
                        work_.parameters.sweep.scheme};
    PencilMemory& memory = result.point.epsilon == 0 ? work_.memory.rigid : work_.memory.flexible;
    work_.memory.forget_ends();
    for (const Index k : {position - 1, position})  // the neighbours, between which the ends are interpolated
      if (k >= 0 && k < count(points_) && points_[at(k)].ends) memory.visited.push_back(*points_[at(k)].ends);
    SpectralRadius plain = spectral_radius(b, work_.options, &work_.memory);
    if (plain.solver == "arpack") {  // bounds nothing
      plain.converged = false;
      plain.failure = "arpack: its ends are not proved";
    }
    if (!memory.visited.empty()) {
      const PencilMemory::Visited& last = memory.visited.back();
      if (last.epsilon == result.point.epsilon && last.eta == result.point.eta) known.ends = last;
    }
    set_exact(result, plain, work_.options.tolerance);
    withdraw_if_uncertain(result.radius, work_.selection);
    factorisations_ += plain.factorisations;
    if (!result.radius.converged) return;
    known.point = curve_point(b, plain, work_.parameters.axis);
    known.point.radius = result.radius.subdominant;
  }

  // Updates the deviations on both sides of a new point.
  void update(Index position) {
    if (count(points_) < 2 || !converged_) return;
    if (deviations_.size() + 1 < points_.size())
      deviations_.emplace(deviations_.begin() + std::max<Index>(position - 1, 0));
    for (const Index k : {position - 1, position})
      if (k >= 0 && k + 1 < count(points_))
        deviations_[at(k)] = deviation(law_, points_[at(k)].point, points_[at(k + 1)].point);
  }

  // The larger deviation of the intervals on both sides of a row.
  double beside(Index row, double Deviation::*side) const {
    double value = 0;
    for (const Index k : {row - 1, row})
      if (k >= 0 && k < count(deviations_)) value = std::max(value, deviations_[at(k)].*side);
    return value;
  }
  double below(Index row) const { return beside(row, &Deviation::below); }
  double above(Index row) const { return beside(row, &Deviation::above); }

  double allowed(Index row) const { return work_.parameters.tolerance * std::max(1.0, points_[at(row)].point.radius); }
  double excess(Index row) const { return (below(row) + above(row)) / allowed(row); }
  double width(Index k) const { return deviations_[at(k)].below + deviations_[at(k)].above; }

  // Whether nearer neighbours cannot improve a row: next to epsilon or eta = 0 digits are lost.
  bool uncertain(Index row) const { return uncertainty(law_, points_[at(row)].point) > 0.5 * allowed(row); }

  bool proved() const {
    return std::ranges::none_of(natural_order(count(points_)), [&](Index row) { return excess(row) > 1; });
  }

  // The row whose band is too wide by the largest factor, among those that more points improve.
  std::optional<Index> worst_row() const {
    std::optional<Index> worst;
    for (Index row = 0; row < count(points_); ++row)
      if (excess(row) > (worst ? excess(*worst) : 1) && !uncertain(row)) worst = row;
    return worst;
  }
  Index widest_beside(Index row) const {
    if (row == 0) return 0;
    return row < count(deviations_) && width(row) > width(row - 1) ? row : row - 1;
  }

  // The parts an interval is to be cut into: its deviation falls with the square of its length.
  Index parts_of(Index k, Index row) const {
    const double times = std::max(width(k), 0.5 * (below(row) + above(row))) / allowed(row);
    return std::max<Index>(2, static_cast<Index>(std::ceil(std::sqrt(std::min(times, 1e6)))));
  }

  Index expected() const {
    Index more = 0;
    for (Index k = 0; k < count(deviations_); ++k)
      if (width(k) > allowed(k)) more += parts_of(k, k) - 1;
    return std::max<Index>(1, more);
  }

  // The next point of an interval, in the unit of the range: at a third if three parts suffice, because halves would
  // become four, and at a kink, which makes the band wide far from the middle.
  double place(Index k, Index row) const {
    const Index parts = parts_of(k, row), first = parts <= 3 ? 1 : parts / 2;
    const double widest = deviations_[at(k)].place;
    const bool kink = widest < 0.3 || widest > 0.7;
    const double share =
        kink ? std::clamp(widest, 0.05, 0.95) : static_cast<double>(first) / static_cast<double>(parts);
    const double from = asked(k), to = asked(k + 1);
    return with_six_digits(from * std::pow(to / from, share), from, to);
  }

  CurveReport report_as(CurveStatus status) const { return {status, count(points_), factorisations_, failure_}; }

  Work& work_;
  SweepPoint start_;
  CurveLaw law_;
  std::vector<Known> points_;
  std::vector<Deviation> deviations_;
  Index factorisations_ = 0;
  bool converged_ = true;
  std::string failure_;
};

// Throws Error for a sweep whose curves cannot be proved.
void require_provable(const SweepParameters& sweep, std::string_view dashes) {
  for (const auto& sweeps : sweep.gauss_seidel_sweeps)
    if (sweeps)
      fail("{0}gauss-seidel-sweeps: expected inf with {0}curve (an inexact Stage 1 has no symmetric pencil), met {1}",
           dashes, *sweeps);
  for (const auto& relaxation : sweep.relaxation)
    if (!relaxation)
      fail("{0}relaxation: expected numbers with {0}curve (the optimal one changes along the curve), met optimal",
           dashes);
  const auto solver = sweep.spectral.solver;
  if (solver == SpectralSolver::arpack || solver == SpectralSolver::slepc)
    fail("{0}solver: expected auto, dense or shift-invert with {0}curve (others prove no end of a spectrum), met {1}",
         dashes, to_string(solver));
}

}  // namespace

CurveParameters curve_parameters(double tolerance, const std::string& epsilon, const std::string& eta,
                                 SweepParameters rest, std::string_view dashes) {
  if (!(tolerance > 0 && std::isfinite(tolerance)))
    fail("{}curve: expected a finite tolerance > 0, met {}", dashes, tolerance);
  require_provable(rest, dashes);
  const auto along_epsilon = parse_range(epsilon, "epsilon"), along_eta = parse_range(eta, "eta");
  if (along_epsilon.has_value() == along_eta.has_value())
    fail(
        "{0}curve: expected one range FROM:TO without a count, of {0}epsilon or of {0}eta, met {0}epsilon {1} {0}eta "
        "{2}",
        dashes, epsilon, eta);
  CurveParameters curve{
      .sweep = std::move(rest), .axis = along_epsilon ? CurveAxis::epsilon : CurveAxis::eta, .tolerance = tolerance};
  std::tie(curve.sweep.epsilon, curve.sweep.relative_epsilon) = along_epsilon ? *along_epsilon : parse_epsilon(epsilon);
  std::tie(curve.sweep.eta, curve.sweep.relative_eta) = along_eta ? *along_eta : parse_eta(eta);
  check_sweep(curve.sweep, dashes);
  return curve;
}

ResultColumns<CurveResult> curve_columns(const SweepParameters& parameters) {
  return joined<CurveResult>(
      {columns_of(&CurveResult::found, sweep_columns(parameters)),
       {{"curve_low", "1", "lower bound of the subdominant radius, by straight lines over log from row to row",
         &CurveResult::low},
        {"curve_high", "1", "upper bound in the same way", &CurveResult::high}}});
}

std::vector<CurveReport> trace_curves(const Model& model, const CurveParameters& parameters,
                                      const Sink<CurveResult>& sink, const Monitor& monitor) {
  Work work(model, parameters);
  SweepParameters starts = parameters.sweep;
  std::vector<double>& along = work.along_epsilon() ? starts.epsilon : starts.eta;
  along.resize(1);
  std::vector<CurveReport> reports;
  Index points = 0;
  for (Index number = 0; number < point_count(starts); ++number) {
    Curve curve(work, sweep_point(starts, number));
    reports.push_back(curve.trace(monitor, points));
    if (reports.back().status == CurveStatus::stopped) break;
    curve.hand_over(sink);
    points += reports.back().points;
  }
  return reports;
}

}  // namespace nscdd
