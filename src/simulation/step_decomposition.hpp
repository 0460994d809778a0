// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include "simulation/step_partition.hpp"
#include <nscdd/ddm/interface_operator.hpp>

namespace nscdd {

/// The flexibility with the smallest predicted radius (see optimal_eta) for the network that 100 sweeps of
/// the undecomposed step find. It is sought anew with every decomposition and kept in between, but raised to
/// stable_eta of the contacts of this step: networks change from iteration to iteration, and the best value
/// for one may diverge on those before it.
double best_eta(const Simulation& simulation, const StepProblem& problem, const Partition& partition);

/// X_eta of the linear Stage 2 of a step. With `network` active, and always in the semi-implicit scheme, it
/// has the contacts that carried an impulse in the step before; otherwise all that are considered.
InterfaceOperator enriched_operator(const Simulation& simulation, const StepProblem& problem,
                                    const Partition& partition, double eta);

}  // namespace nscdd
