// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/run_simulation.hpp"

#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace nscdd {
namespace {

// The next step; if there is none, `reason` says why.
std::optional<SolvedStep> solve_or_explain(const Simulation& simulation, const IterationSink& sink,
                                           std::string& reason) {
  try {
    SolvedStep step = solve_step(simulation, sink);
    const SolverStatus status = step.report.status;
    if (status != SolverStatus::diverged && status != SolverStatus::no_number) return step;
    reason = fmt::format("step {}: {} after {} iterations, {}", step.report.step, to_string(status),
                         step.report.last.iteration, describe_breakdown(simulation, step));
  } catch (const Error& error) {
    if (simulation.state.step == 0) throw;
    reason = fmt::format("step {}: {}", simulation.state.step + 1, error.what());
  }
  return std::nullopt;
}

// Whether grains have come to rest: they were slow for `rest_steps` steps, and not faster from each step to
// the next, which is how a fall begins.
class RestWatch {
 public:
  explicit RestWatch(double rest_speed) : rest_speed_(rest_speed) {}

  void add(double speed) {
    if (!(speed < rest_speed_)) slow_.clear();
    if (speed < rest_speed_) slow_.push_back(speed);
  }
  bool at_rest() const {
    if (count(slow_) < rest_steps) return false;
    const auto begin = slow_.end() - rest_steps;
    return std::adjacent_find(begin, slow_.end(), std::greater_equal<>()) != slow_.end();
  }

 private:
  double rest_speed_;
  std::vector<double> slow_;
};

}  // namespace

double mean_speed(const GranularSystem& system, double kinetic_energy) {
  double mass = 0;
  for (Index i = 0; i < system.disks(); ++i)
    if (system.free(i)) mass += system.mass[at(i)];
  return std::sqrt(2 * kinetic_energy / mass);
}

RunOutcome run_simulation(Simulation& simulation, const RunSinks& sinks, const std::vector<double>& speeds_before) {
  const TimeStepping time = simulation.dynamics.time;
  RunOutcome outcome;
  RestWatch rest(time.rest_speed);
  for (const double speed : speeds_before) rest.add(speed);
  while (simulation.state.step < time.steps && !rest.at_rest()) {
    std::optional<SolvedStep> solved = solve_or_explain(simulation, sinks.iteration, outcome.reason);
    if (!solved) {
      outcome.end = RunEnd::broke_down;
      return outcome;
    }
    StepReport report;
    if (sinks.step) {
      report = take_step(simulation, *solved);
      sinks.step(simulation, *solved, report);
    } else {
      report = take_step(simulation, *std::move(solved));
    }
    rest.add(mean_speed(simulation.system, report.energy.kinetic));
    if (!nscdd::report(sinks.monitor, simulation.state.step, time.steps)) {
      outcome.end = RunEnd::stopped;
      return outcome;
    }
  }
  if (rest.at_rest()) outcome.end = RunEnd::at_rest;
  return outcome;
}

}  // namespace nscdd
