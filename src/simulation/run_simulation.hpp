// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"
#include <nscdd/core/choice.hpp>
#include <nscdd/core/types.hpp>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace nscdd {

/// Why a run of a simulation ended.
enum class RunEnd {
  completed,   ///< TimeStepping::steps are done
  at_rest,     ///< mean_speed was below TimeStepping::rest_speed for `rest_steps` steps, without always rising
  stopped,     ///< the monitor asked for it
  broke_down,  ///< a step could not be prepared (see prepare_solution), diverged, or gave values that are not
               ///< finite
};
constexpr auto names_of(RunEnd) {
  return std::to_array<std::string_view>({"completed", "at rest", "stopped", "broke down"});
}

/// So many steps in a row grains must be slow before they count as at rest: a turning point of their motion
/// is not rest.
inline constexpr Index rest_steps = 10;

struct RunOutcome {
  RunEnd end = RunEnd::completed;
  std::string reason;  ///< of a breakdown: the step, and the grain or contact
};

/// Called after each step taken, with the simulation behind it and the step as it was solved.
using StepSink = std::function<void(const Simulation& after, const SolvedStep& solved, const StepReport& report)>;

/// What may follow a run; each may be empty.
struct RunSinks {
  IterationSink iteration;
  StepSink step;
  Monitor monitor;  ///< after each step, of steps done and asked for
};

/// Takes steps until TimeStepping::steps are done, the grains rest, the monitor asks to stop or a step breaks
/// down. In the end the simulation is as the last good step left it. `speeds_before`: mean_speed after each
/// step of the run that this one goes on with. Throws Error if the very first step cannot be prepared,
/// because that is bad input.
RunOutcome run_simulation(Simulation& simulation, const RunSinks& sinks, const std::vector<double>& speeds_before = {});

/// Root mean square velocity of the free grains, weighted by mass and with their spin, m/s: sqrt(2 E / m)
/// with their kinetic energy E and their mass m.
double mean_speed(const GranularSystem& system, double kinetic_energy);

}  // namespace nscdd
