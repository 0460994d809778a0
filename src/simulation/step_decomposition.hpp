// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/step_share.hpp"
#include <nscdd/ddm/interface_operator.hpp>

namespace nscdd {

/// M, H and the partition of a step for the linear analysis, with a column for each direction of a contact. Of
/// several processes each has its own subdomains, see PackingShare.
template <int D>
Decomposition linear_decomposition(const Simulation& simulation, const GranularStep<D>& step);

/// Factorisation method of Stage 2: that of the simulation, or multifrontal() if it has none.
InertiaMethod stage_two_inertia(const Simulation& simulation);

/// X_eta of the linear Stage 2 of a step. With `network` active, and always in the semi-implicit scheme, it
/// has the contacts that carried an impulse in the step before; otherwise all that are considered.
template <int D>
InterfaceOperator enriched_operator(const Simulation& simulation, const GranularStep<D>& step, double eta);

/// The flexibility with the smallest predicted radius (see optimal_eta) for the network that 100 sweeps of the
/// undecomposed step find. It is sought anew with every decomposition and kept in between, but raised to stable_eta of
/// the contacts of this step: networks change from iteration to iteration, and the best for one may diverge on those
/// before.
template <int D>
double best_eta(const Simulation& simulation, const GranularStep<D>& step);

}  // namespace nscdd
