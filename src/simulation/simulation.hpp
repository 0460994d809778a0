// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/solved_step.hpp"

namespace nscdd {

/// The next step of a simulation cut into subdomains, to be solved by any method. Throws Error as share_step does.
template <int D>
std::pair<GranularStep<D>, GranularDecomposition<D>> divide_step(const Simulation& simulation);

/// The same ready to be iterated by Algorithm 1.
template <int D>
struct PreparedStep {
  GranularStep<D> share;                      ///< the step, or what this process has of it
  std::optional<InterfaceOperator> enriched;  ///< X_eta of the enriched algorithm
  GranularTwoStage<D> iteration;
};
template <int D = 2>
PreparedStep<D> prepare_solution(const Simulation& simulation);

/// Prepares and solves the next step without taking it. The iterations that `sink` looks at go to it. Throws Error for
/// a system of another dimension than D.
template <int D = 2>
GranularStep<D> solve_step(const Simulation& simulation, const IterationSink& sink = {});

/// How the next step of a simulation of either dimension is solved, without taking it.
StepReport solved_report(const Simulation& simulation, const IterationSink& sink = {});

/// Why a run of a simulation ended.
enum class RunEnd {
  completed,   ///< TimeStepping::steps are done
  at_rest,     ///< mean_speed was below TimeStepping::rest_speed for `rest_steps` steps, without always rising
  stopped,     ///< the monitor asked for it, or a step was given up (IterationSink::goes_on)
  broke_down,  ///< a step could not be prepared (see prepare_solution), diverged, or gave values not finite
};
constexpr auto names_of(RunEnd) {
  return std::to_array<std::string_view>({"completed", "at rest", "stopped", "broke down"});
}

/// Number of slow steps in a row after which grains count as at rest: a turning point of their motion is not rest.
inline constexpr Index rest_steps = 10;

struct RunOutcome {
  RunEnd end = RunEnd::completed;
  std::string reason = {};  ///< of a breakdown: the step, and the grain or contact
};

/// What may follow a run; each may be empty.
struct RunSinks {
  IterationSink iteration;
  /// After each step taken, with the simulation behind it and the step as it was solved.
  std::function<void(const Simulation& after, const AnySolvedStep& solved, const StepReport& report)> step;
  Monitor monitor;  ///< after each step, of steps done and asked for
};

/// Takes steps until TimeStepping::steps are done, the grains rest, the monitor asks to stop or a step breaks down. The
/// simulation is then in the state after the last good step. `speeds`: mean_speed after each step of the run that this
/// one continues. Throws Error if the very first step cannot be prepared, because that is bad input.
RunOutcome run_simulation(Simulation& simulation, const RunSinks& sinks, std::vector<double> speeds = {});

/// Root mean square velocity of the free grains, m/s: sqrt(2 E / m), their kinetic energy E with spin, their mass m.
double mean_speed(const GranularSystem& system, double kinetic_energy);

}  // namespace nscdd
