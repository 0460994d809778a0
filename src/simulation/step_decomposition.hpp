// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/step_share.hpp"

namespace nscdd {

/// M, H and the partition of a step for the linear analysis, with a column for each direction of a contact. Each rank
/// has its own subdomains, see PackingShare.
template <int D>
Decomposition linear_decomposition(const Simulation& simulation, const GranularStep<D>& step) {
  const std::vector<std::int32_t>& numbers = step.problem.numbers;
  const auto walls = std::ranges::lower_bound(numbers, static_cast<std::int32_t>(simulation.system.bodies()));
  const std::vector<Index> grains(numbers.begin(), walls);
  return decompose(reference_problem(step.problem, count(grains)), partition_of_columns(step.partition, D),
                   GluingShape::chain, {grains, step.process_of_subdomain, simulation.processes});
}

/// Adds the centres of the bodies of a step and what their spins are (Subdomain::turning), for `rigid_vectors`.
void add_places(Decomposition& parts, const Simulation& simulation);

/// X_eta of the linear Stage 2 of a step, of all contacts considered. With `network` active, and in the semi-implicit
/// scheme, only of those that carried an impulse in the step before.
template <int D>
InterfaceOperator enriched_operator(const Simulation& simulation, const GranularStep<D>& step, double eta);

/// The flexibility with the smallest predicted radius (see optimal_eta) for the network after 100 sweeps of the
/// undecomposed step. It is recomputed with every fresh decomposition, and at least stable_eta of the contacts of this
/// step: networks change from iteration to iteration, and the best for one may diverge on those before.
template <int D>
double best_eta(const Simulation& simulation, const GranularStep<D>& step);

}  // namespace nscdd
