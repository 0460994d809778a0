// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include <nscdd/ddm/interface_operator.hpp>

namespace nscdd {

/// What a process must know of its share of a step, see StepShare, beside the contacts of its own subdomains.
struct ShareOfStep {
  std::vector<Index> process_of_subdomain = {};  ///< see deal_out; empty where `problem` is the whole step
  std::vector<RememberedImpulse> impulses = {};  ///< of the step before at these contacts, among others
};

/// Throws Error for a system of another dimension, and naming the grain if a contact solver cannot take its mass.
void check_system(const Simulation& simulation, Index dimension);

/// The next step of a simulation before it is divided. Throws Error as prepare_step, and naming both bodies
/// if two overlap by more than `largest_overlap`, and for a system of another dimension than D.
template <int D>
StepProblem<D> checked_problem(const Simulation& simulation);

/// Whether a step is partitioned afresh, which happens every `redecompose` steps.
bool decomposes_afresh(const Simulation& simulation, Index step);

/// The subdomain of each contact that a step considers. Between two fresh partitions known contacts stay where they
/// are, and a process knows those of its own subdomains alone: for pairs that lie wholly in others it may name any of
/// these. `whole`: the step with all contacts, which METIS alone asks for. The simulation must outlive the result.
using SubdomainOfContact = std::function<Index(const StepContact&)>;
template <int D>
SubdomainOfContact subdomain_of_contact(const Simulation& simulation, const std::function<StepProblem<D>()>& whole);

/// What is remembered of contacts, ascending by (a, b), and of their partition.
std::vector<RememberedSubdomain> subdomains_to_remember(const std::vector<StepContact>& contacts,
                                                        const Partition& partition);

/// The partition of the contacts of a step. Between two fresh ones, known contacts stay where they are.
template <int D>
Partition partition_step(const Simulation& simulation, const StepProblem<D>& problem);

/// The flexibility with the smallest predicted radius (see optimal_eta) for the network that 100 sweeps of the
/// undecomposed step find. It is sought anew with every decomposition and kept in between, but raised to stable_eta of
/// the contacts of this step: networks change from iteration to iteration, and the best for one may diverge on those
/// before.
template <int D>
double best_eta(const Simulation& simulation, const StepProblem<D>& problem, const Partition& partition,
                const ShareOfStep& share = {});

/// M, H and the partition of a step for the linear analysis, with a column for each direction of a contact. Of
/// several processes each has its own subdomains, see PackingShare; `problem` is then its share of the step.
template <int D>
Decomposition linear_decomposition(const Simulation& simulation, const StepProblem<D>& problem,
                                   const Partition& partition, const ShareOfStep& share = {});

/// What factorises for Stage 2 of a step: the simulation's own method, or multifrontal() where it has none.
InertiaMethod stage_two_inertia(const Simulation& simulation);

/// X_eta of the linear Stage 2 of a step. With `network` active, and always in the semi-implicit scheme, it
/// has the contacts that carried an impulse in the step before; otherwise all that are considered.
template <int D>
InterfaceOperator enriched_operator(const Simulation& simulation, const StepProblem<D>& problem,
                                    const Partition& partition, double eta, const ShareOfStep& share = {});

}  // namespace nscdd
