// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include <nscdd/ddm/interface_operator.hpp>

namespace nscdd {

/// The next step of a simulation before it is divided. Throws Error as prepare_step, and naming both bodies
/// if two overlap by more than `largest_overlap`, and for a system of another dimension than D.
template <int D>
StepProblem<D> checked_problem(const Simulation& simulation);

/// Whether a step is partitioned afresh, which happens every `redecompose` steps.
bool decomposes_afresh(const Simulation& simulation, Index step);

/// The partition of the contacts of a step. Between two fresh ones, known contacts stay where they are.
template <int D>
Partition partition_step(const Simulation& simulation, const StepProblem<D>& problem);

/// The flexibility with the smallest predicted radius (see optimal_eta) for the network that 100 sweeps of the
/// undecomposed step find. It is sought anew with every decomposition and kept in between, but raised to stable_eta of
/// the contacts of this step: networks change from iteration to iteration, and the best for one may diverge on those
/// before.
template <int D>
double best_eta(const Simulation& simulation, const StepProblem<D>& problem, const Partition& partition);

/// M, H and the partition of a step for the linear analysis, with a column for each direction of a contact. Of
/// several processes each has the subdomains whose contacts it sweeps.
template <int D>
Decomposition linear_decomposition(const Simulation& simulation, const StepProblem<D>& problem,
                                   const Partition& partition);

/// What factorises for Stage 2 of a step: the simulation's own method, or multifrontal() where it has none.
InertiaMethod stage_two_inertia(const Simulation& simulation);

/// X_eta of the linear Stage 2 of a step. With `network` active, and always in the semi-implicit scheme, it
/// has the contacts that carried an impulse in the step before; otherwise all that are considered.
template <int D>
InterfaceOperator enriched_operator(const Simulation& simulation, const StepProblem<D>& problem,
                                    const Partition& partition, double eta);

}  // namespace nscdd
