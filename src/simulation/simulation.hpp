// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/solved_step.hpp"

namespace nscdd {

/// The next step of a simulation and its decomposition. Throws Error as share_step.
template <int D>
std::pair<GranularStep<D>, GranularDecomposition<D>> divide_step(const Simulation& simulation);

/// The next step of a simulation, ready for the iterations of Algorithm 1.
template <int D>
struct PreparedStep {
  GranularStep<D> share;                      ///< of this rank
  std::optional<InterfaceOperator> enriched;  ///< X_eta of the enriched algorithm
  GranularTwoStage<D> iteration;
};
template <int D = 2>
PreparedStep<D> prepare_solution(const Simulation& simulation);

/// Prepares and solves the next step without taking it, again with stronger bonds (Interaction::bond_strength) if one
/// opens or slides. Throws Error as share_step.
template <int D = 2>
GranularStep<D> solve_step(const Simulation& simulation, const IterationSink& sink = {});

/// The report of solve_step in the dimension of the simulation.
StepReport solved_report(const Simulation& simulation, const IterationSink& sink = {});

/// Why a run of a simulation ended.
enum class RunEnd {
  completed,   ///< TimeStepping::steps are done
  at_rest,     ///< mean_speed was below TimeStepping::rest_speed for `rest_steps` steps, without always rising
  stopped,     ///< by the monitor, or in a step by IterationSink::goes_on
  broke_down,  ///< a step could not be prepared (see prepare_solution), diverged, or gave values not finite
  impossible,  ///< a step has no solution, and StepSolver::impossible is `stop`
};
constexpr auto names_of(RunEnd) {
  return std::to_array<std::string_view>({"completed", "at rest", "stopped", "broke down", "impossible"});
}

/// Whether a run ended at a step that it could not take.
inline bool failed(RunEnd end) { return end == RunEnd::broke_down || end == RunEnd::impossible; }

/// Slow steps in a row after which grains are at rest: a turning point of their motion is not rest.
inline constexpr Index rest_steps = 10;

struct RunOutcome {
  RunEnd end = RunEnd::completed;
  std::string reason = {};               ///< of a breakdown or impossible step: its number, and grains or contacts
  std::vector<ChainContact> chain = {};  ///< of the impossible step
};

/// Observers of a run; each may be empty.
struct RunSinks {
  IterationSink iteration;
  /// Called after each step taken.
  std::function<void(const Simulation& after, const AnySolvedStep& solved, const StepReport& report)> step;
  Monitor monitor;  ///< after each step, of steps done and asked for
};

/// Takes steps until a RunEnd; the state is then that after the last good step. `speeds`: mean_speed after each step of
/// a run that this one continues. Throws Error if the very first step cannot be prepared: that is bad input.
RunOutcome run_simulation(Simulation& simulation, const RunSinks& sinks, std::vector<double> speeds = {});

/// Root mean square velocity of the free grains, m/s: sqrt(2 E / m), with their kinetic energy E, spins included.
double mean_speed(const GranularSystem& system, double kinetic_energy);

}  // namespace nscdd
