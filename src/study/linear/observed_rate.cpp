// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/observed_rate.hpp"

#include "linalg/random.hpp"
#include "linalg/scalar.hpp"
#include "study/linear/sweep_points.hpp"
#include "study/tables/study.hpp"

namespace nscdd {
namespace {

// Ratio of successive corrections below which the algorithm is done: its radius is 0.
constexpr double done_ratio = 1e-13;

// The corrections F_{i+1} - F_i of a run without loads. They obey the linear iteration themselves, and are iterated in
// place of F, which keeps their digits. They are rescaled, so that a long run never underflows.
class Run {
 public:
  Run(const TwoStageIteration& iteration, const InterfaceOperator& preconditioner, std::uint64_t seed)
      : iteration_(iteration), preconditioner_(preconditioner) {
    Vector start = Vector::Zero(iteration.rows());
    start.tail(iteration.interface_size()) = RandomStream(seed).normal_vector(iteration.interface_size());
    const double before = norm(start);
    correction_ = iteration_.iterate(start) - start;
    record(norm(correction_), before);
  }

  // One iteration; false once the correction has vanished.
  bool advance() {
    if (vanished_) return false;
    const double before = norm(correction_);
    correction_ = iteration_.iterate(std::move(correction_));
    const double after = norm(correction_);
    record(after, before);
    if (!vanished_ && iteration_.rigid() && after < 1e-6 * last_cleaned_) clean(after);
    if (!vanished_ && (after < 1e-100 || after > 1e100)) {
      correction_ *= 1 / after;
      offset_ += std::log(after);
      last_cleaned_ = 1;
    }
    return !vanished_;
  }

  bool lost() const { return lost_; }  // a norm is not a number

  std::vector<double> logarithms;  // of the norms of the corrections

 private:
  double norm(const Vector& z) const {
    if (iteration_.schwarz()) return iteration_.norm_of_impulses(z);
    const Vector f = z.tail(iteration_.interface_size());
    return std::sqrt(std::max(f.dot(preconditioner_.apply(f)), 0.0));
  }
  void record(double norm, double before) {
    vanished_ = !(norm > done_ratio * before);
    lost_ = std::isnan(norm);
    if (last_cleaned_ == 0) last_cleaned_ = norm;
    if (!vanished_) logarithms.push_back(std::log(norm) + offset_);
  }
  // Components of unit eigenvalues of a hyperstatic rigid limit do not decay, and rounding feeds them. A further
  // difference removes them; its constant factor is scaled away.
  void clean(double size) {
    correction_ = iteration_.iterate(correction_) - correction_;
    const double cleaned = norm(correction_);
    if (cleaned > 0) correction_ *= size / cleaned;
    last_cleaned_ = size;
  }

  const TwoStageIteration& iteration_;
  const InterfaceOperator& preconditioner_;
  Vector correction_;  // of z, see TwoStageIteration
  double offset_ = 0, last_cleaned_ = 0;
  bool vanished_ = false, lost_ = false;
};

LinearFit fitted(const std::vector<double>& y, std::size_t first, std::size_t last) {
  std::vector<double> x;
  for (std::size_t i = first; i < last; ++i) x.push_back(static_cast<double>(i));
  return linear_fit(x, std::span(y).subspan(first, last - first));
}

ResultColumns<ObservedResult> observed_rate_columns(const SweepParameters& parameters) {
  using Result = ObservedResult;
  return joined<Result>(
      {columns_of(&Result::predicted, place_columns()),
       {{"predicted_rate", "1", "subdominant spectral radius of the contraction operator",
         [](const Result& r) { return r.predicted.radius.subdominant; }},
        {"observed_rate", "1", "rate fitted to a run of the algorithm itself",
         [](const Result& r) { return r.observed.value; }},
        {"observed_rate_error", "1", "error of the fit", [](const Result& r) { return r.observed.error; }},
        {"difference", "1", "observed minus predicted", &Result::difference},
        {"agree", "1", "|difference| within the error of the fit and the residual of the prediction", &Result::agree},
        {"iterations", "1", "iterations run", [](const Result& r) { return r.observed.iterations; }},
        {"seed", "1", "seed of the random first F_Gamma", &Result::seed},
        {"residual", "1", "residual of the prediction", [](const Result& r) { return r.predicted.radius.residual; }},
        {"converged", "1", "both the fit and the prediction converged", &Result::converged}},
       columns_of(&Result::predicted, asked_columns(parameters))});
}

}  // namespace

ObservedRate observed_rate(const TwoStageIteration& iteration, const InterfaceOperator& preconditioner,
                           std::uint64_t seed, Index maximum_iterations, double tolerance) {
  ObservedRate observed;
  if (iteration.interface_size() == 0) return observed;
  Run run(iteration, preconditioner, seed);
  for (Index target = 48;; target = std::min(2 * target, maximum_iterations)) {
    while (count(run.logarithms) < target)
      if (!run.advance()) {
        observed.iterations = count(run.logarithms);
        if (run.lost()) observed = {not_a_number, not_a_number, observed.iterations, false};
        return observed;  // else rate 0: nothing left to correct
      }
    // The slopes of the last three sixths approach log(rate) geometrically. Their ratio bounds the remaining drift.
    const std::size_t n = run.logarithms.size(), sixth = n / 6;
    const double s1 = fitted(run.logarithms, n - 3 * sixth, n - 2 * sixth).slope;
    const double s2 = fitted(run.logarithms, n - 2 * sixth, n - sixth).slope;
    const auto [intercept, s3, standard_error] = fitted(run.logarithms, n - sixth, n);
    const double ratio = s2 == s1 ? 0.0 : std::min(0.99, std::abs((s3 - s2) / (s2 - s1)));
    const double drift = std::abs(s3 - s2) * std::max(1.0, ratio / (1 - ratio));
    // A complex pair makes the residuals of the fit oscillate. Fully correlated residuals shift the slope by up to the
    // standard error times the root of their number.
    const double correlated_error = standard_error * std::sqrt(static_cast<double>(sixth));
    observed.value = std::exp(s3);
    observed.error = observed.value * (correlated_error + drift);
    observed.iterations = count(run.logarithms);
    observed.converged = observed.error <= tolerance;
    if (observed.converged || target >= maximum_iterations) return observed;
  }
}

bool ObservedResult::agree() const {
  constexpr double rounding = 1e-12;  // of both
  return std::abs(difference()) <= observed.error + predicted.radius.residual + rounding;
}

Index observe(const Model& model, const SweepParameters& parameters, std::uint64_t seed,
              const Sink<ObservedResult>& sink, const Monitor& monitor, Index first) {
  const Selection selection = select(model, parameters.contacts);
  const Decomposition stage_one =
      parameters.schwarz() ? whole_masses(selection.stage_one(model)) : selection.stage_one(model);
  const InterfaceFamily family(parameters.schwarz() ? stage_one : model.parts);
  Index failed = 0;
  const auto observe_one = [&](const SweepResult& predicted) {
    const SweepPoint& point = predicted.point;
    const InterfaceOperator preconditioner = family.at(point.eta);
    const TwoStageIteration iteration(stage_one, LinearViscous{point.epsilon}, preconditioner,
                                      point.gauss_seidel_sweeps, *point.relaxation, parameters.scheme);
    // With an inexact Stage 1 the corrections oscillate: the error of the fit falls only with the length of the run.
    const double tolerance = point.gauss_seidel_sweeps ? 1e-4 : 1e-9;
    const ObservedResult result{predicted, observed_rate(iteration, preconditioner, seed, 20000, tolerance), seed};
    failed += !result.converged();
    sink(result);
  };
  sweep(model, parameters, observe_one, monitor, first);
  return failed;
}

constinit const Observable observables::observed_rate{
    .name = "observed_rate",
    .summary = "rate fitted to a run of the algorithm, beside the predicted radius",
    .keys = {"epsilon", "eta", "relaxation", "gauss_seidel_sweeps", "contacts", "solver", "certify", "seed", "scheme"},
    .columns = [](const StudyTable& table) { return headings(observed_rate_columns(table.sweep)); },
    .run =
        [](const ObservedCase& work) {
          return observe(built_for(work.table.sweep, work.one), work.table.sweep, work.table.seed,
                         as_rows(observed_rate_columns(work.table.sweep), work.sink), work.monitor, work.first);
        },
    .rows = [](const StudyTable& table) { return point_count(table.sweep); },
    .known =
        [](const StudyTable& table, Index row) {
          KnownCells cells = known_of_point(table, row);
          cells.emplace_back("seed", static_cast<Index>(table.seed));
          return cells;
        }};

}  // namespace nscdd
