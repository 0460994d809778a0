// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/scalar.hpp"
#include "study/moving/compared_rates.hpp"
#include "study/moving/moving_tables.hpp"

namespace nscdd {
namespace {

constexpr double rounding = 1e-13;   // of the second differences of F
constexpr double least_change = 10;  // the half that is fitted must fall, or grow, by at least this factor
constexpr double largest_drift = 0.1;
constexpr std::size_t shortest = 12;  // iterations in the half that is fitted

// Iterations without a change of status.
template <int D>
struct Stretch {
  Index first = 0;
  // |F_i - 2 F_{i-1} + F_{i-2}| / |F_i| down to rounding, and Z of the same iterations
  std::vector<double> second_changes, z;
  std::vector<ContactStatus> statuses;
  std::vector<FrozenContact<D>> frozen;  // at the last of these iterations

  std::size_t middle() const { return second_changes.size() / 2; }
  // log of the factor by which the last half falls or, where the frozen map is unstable, grows.
  double change() const {
    if (second_changes.size() < 2 * shortest) return 0;
    return std::abs(std::log(second_changes.back() / second_changes[middle()]));
  }
};

// Keeps the stretch of a run with the largest change.
template <int D>
class Stretches {
 public:
  void record(const GranularTwoStage<D>& iteration) {
    const IterationRecord record = iteration.record();
    if (std::vector<ContactStatus> statuses = iteration.statuses(); statuses != now_.statuses) {
      close();
      now_ = {.first = record.iteration, .second_changes = {}, .z = {}, .statuses = std::move(statuses), .frozen = {}};
      ended_ = false;
    }
    ended_ = ended_ || !(record.interface_second_change > rounding);
    if (ended_) return;
    now_.second_changes.push_back(record.interface_second_change);
    now_.z.push_back(record.interface_change);
    now_.frozen = frozen_contacts(iteration.parts(), now_.statuses);
  }
  Stretch<D> best() {
    close();
    return best_;
  }

 private:
  void close() {
    if (now_.change() > best_.change()) best_ = now_;
  }
  Stretch<D> now_, best_;
  bool ended_ = false;
};

template <int D>
void fit(PredictedObserved& result, const Stretch<D>& stretch) {
  if (stretch.change() < std::log(least_change)) return;
  const std::size_t begin = stretch.middle();
  std::vector<double> x, y, z;
  for (std::size_t k = begin; k < stretch.second_changes.size(); ++k) {
    x.push_back(static_cast<double>(k - begin));
    y.push_back(std::log(stretch.second_changes[k]));
    z.push_back(std::log(stretch.z[k]));
  }
  const LinearFit line = linear_fit(x, y);
  const std::size_t half = x.size() / 2;
  const std::span<const double> all_x(x), all_y(y);
  const double drift = std::abs(linear_fit(all_x.first(half), all_y.first(half)).slope -
                                linear_fit(all_x.subspan(half), all_y.subspan(half)).slope);
  // A rate that changes so much along the fit belongs to more than one mode.
  if (drift > largest_drift * std::abs(line.slope)) return;
  result.observed = std::exp(line.slope);
  result.rate_z = std::exp(linear_fit(x, z).slope);
  result.observed_error = result.observed * (line.slope_error + drift);
  result.first = stretch.first + static_cast<Index>(begin);
  result.last = stretch.first + count(stretch.second_changes) - 1;
}

template <int D>
PredictedObserved compare_rates(const Simulation& simulation) {
  const StepSolver& solver = simulation.dynamics.solver;
  PreparedStep<D> step = prepare_solution<D>(simulation);
  const GranularDecomposition<D> parts = step.iteration.parts();
  Stretches<D> stretches;
  IterationWatch watch(solver);
  PredictedObserved result;
  result.report = step.share.report;
  std::optional<SolverStatus> status;
  while (!status) {
    if (watch.needs_normal_change()) step.iteration.remember_impulses();
    step.iteration.iterate();
    IterationRecord record = step.iteration.record();
    if (watch.needs_normal_change()) record.normal_change = step.iteration.normal_change();
    stretches.record(step.iteration);
    result.report.last = record;
    if (!watch.judges(record.iteration)) continue;
    status = watch.judge(record, watch.needs_residual() ? step.iteration.residual() : ContactResidual{});
  }
  result.report.status = *status;
  const Stretch<D> best = stretches.best();
  if (best.frozen.empty()) return result;
  fit(result, best);
  predict(result, simulation, parts, best.statuses, best.frozen, step.enriched);
  return result;
}

ResultColumns<PredictedObserved> rate_columns() {
  using Rates = PredictedObserved;
  return {
      {"active", "1", "contacts with an impulse at the statuses compared", &Rates::active},
      {"stick", "1", "of them sticking", &Rates::stick},
      {"slide", "1", "of them sliding", &Rates::slide},
      {"predicted", "1", "spectral radius of the frozen iteration with n_GS sweeps", &Rates::predicted},
      {"predicted_exact", "1", "the same with an exact Stage 1; nan for large packings", &Rates::predicted_exact},
      {"complex_pair", "", "whether the dominant eigenvalue is one of a complex pair", &Rates::complex_pair},
      {"observed", "1",
       "rate fitted to the run; nan where no stretch of fixed statuses falls or grows enough, at one rate",
       &Rates::observed},
      {"observed_error", "1", "standard error of the fit plus the drift of the rate along it", &Rates::observed_error},
      {"relative_gap", "1", "|observed - predicted| / |1 - predicted|", &Rates::relative_gap},
      {"agree", "", "whether that is at most 1 %, or the rates differ by at most three errors of the fit",
       &Rates::agree},
      {"rate_z", "1", "rate fitted to Z itself over the same iterations", &Rates::rate_z},
      {"first_iteration", "1", "first iteration fitted", &Rates::first},
      {"last_iteration", "1", "last iteration fitted", &Rates::last},
      {"iterations", "1", "iterations run", [](const Rates& r) { return r.report.last.iteration; }},
      {"status", "", "how the run ended", [](const Rates& r) { return r.report.status; }},
      {"converged", "", "whether prediction and observation are both known", &Rates::known}};
}

}  // namespace

void require_comparable(const Dynamics& dynamics, const Partitioner& partitioner) {
  const StepSolver& solver = dynamics.solver;
  const auto expect = [](bool right, const char* key, std::string_view expected, std::string_view met) {
    if (!right) fail("{}: expected {} for a rate that is predicted, met {}", key, expected, met);
  };
  expect(has_part(solver.algorithm, StepPart::exchanges), "solver.algorithm", algorithms_with(StepPart::exchanges),
         to_string(solver.algorithm));
  expect(subdomains(partitioner) > 1, "partition", "two subdomains or more", "one");
  expect(solver.interface_method == InterfaceMethod::richardson, "solver.interface_method", "richardson",
         to_string(solver.interface_method));
  expect(solver.enrichment == Enrichment::every_iteration, "solver.enrichment", "every_iteration",
         to_string(solver.enrichment));
  expect(!switches_models(dynamics), "solver.switch", "none", to_string(solver.model));
  expect(solver.contact_relaxation == 1, "solver.contact_relaxation", "1", field_text(solver.contact_relaxation));
  expect(opens(contact_law(dynamics.interaction, dynamics.time.step, 1)), "interaction.law", "a law with open contacts",
         to_string(dynamics.interaction.law));
}

PredictedObserved predicted_observed(const Simulation& simulation) {
  require_comparable(simulation.dynamics, simulation.partitioner);
  return in_dimension(simulation.system, [&](auto dimension) { return compare_rates<dimension()>(simulation); });
}

constinit const Observable observables::predicted_observed = examined_steps<rate_columns, nscdd::predicted_observed>(
    {.name = "predicted_observed",
     .summary = "rate of a step with friction, predicted at its frozen statuses and observed",
     .check = [](const CaseSpec& spec) { require_comparable(*spec.dynamics, spec.partition); }});

}  // namespace nscdd
