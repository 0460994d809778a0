// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/simulation.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace nscdd {
namespace {

// The next step; if there is none, `reason` says why.
std::optional<SolvedStep> solve_or_explain(const Simulation& simulation, const IterationSink& sink,
                                           std::string& reason) {
  try {
    SolvedStep step = solve_step(simulation, sink);
    if (!step.report.broke_down()) return step;
    const auto ended = step.energy_exploded ? "more energy than loads, boundaries and pushes can bring"
                                            : to_string(step.report.status);
    reason = fmt::format("step {}: {} after {} iterations, {}", step.report.step, ended, step.report.last.iteration,
                         describe_breakdown(simulation, step));
  } catch (const Error& error) {
    if (simulation.state.step == 0) throw;
    reason = fmt::format("step {}: {}", simulation.state.step + 1, error.what());
  }
  return std::nullopt;
}

// Whether grains have come to rest: they were slow for `rest_steps` steps, and not faster from each step to
// the next, which is how a fall begins.
bool at_rest(const std::vector<double>& speeds, double rest_speed) {
  if (count(speeds) < rest_steps) return false;
  const auto last = std::span(speeds).last(at(rest_steps));
  return std::ranges::all_of(last, [&](double speed) { return speed < rest_speed; }) &&
         std::ranges::adjacent_find(last, std::ranges::greater_equal()) != last.end();
}

}  // namespace

double mean_speed(const GranularSystem& system, double kinetic_energy) {
  double mass = 0;
  for (Index i = 0; i < system.disks(); ++i)
    if (system.free(i)) mass += system.mass[at(i)];
  return std::sqrt(2 * kinetic_energy / mass);
}

RunOutcome run_simulation(Simulation& simulation, const RunSinks& sinks, std::vector<double> speeds) {
  const TimeStepping time = simulation.dynamics.time;
  while (simulation.state.step < time.steps && !at_rest(speeds, time.rest_speed)) {
    std::string reason;
    const std::optional<SolvedStep> solved = solve_or_explain(simulation, sinks.iteration, reason);
    if (!solved) return {RunEnd::broke_down, reason};
    const StepReport report = take_step(simulation, *solved);
    if (sinks.step) sinks.step(simulation, *solved, report);
    speeds.push_back(mean_speed(simulation.system, report.energy.kinetic));
    if (!nscdd::report(sinks.monitor, simulation.state.step, time.steps)) return {RunEnd::stopped};
  }
  return {at_rest(speeds, time.rest_speed) ? RunEnd::at_rest : RunEnd::completed};
}

}  // namespace nscdd
