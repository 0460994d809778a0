// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/interface_operator.hpp>
#include <nscdd/simulation/dynamics.hpp>

namespace nscdd {

/// The partition of the contacts of a step, afresh every `redecompose` steps, else with known contacts kept.
Partition partition_step(const Simulation& simulation, const StepProblem& problem);
bool decomposes_afresh(const Simulation& simulation, Index step);

/// The flexibility of smallest predicted radius (see optimal_eta) for the network that 100 sweeps of the
/// undecomposed step find, sought anew with every decomposition and kept in between, but none below
/// stable_eta of the contacts of this step. Networks change from iteration to iteration: the best of one may
/// diverge on those before it.
double best_eta(const Simulation& simulation, const StepProblem& problem, const Partition& partition);

/// X_eta of the linear Stage 2 of a step, on the contacts its network has: all considered, or (`network`
/// active, and always in the semi-implicit scheme) those that carried an impulse in the step before.
InterfaceOperator enriched_operator(const Simulation& simulation, const StepProblem& problem,
                                    const Partition& partition, double eta);

}  // namespace nscdd
