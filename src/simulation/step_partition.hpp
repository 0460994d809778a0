// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"

namespace nscdd {

/// Throws Error for a system of another dimension, and naming the grain if a contact solver cannot take its mass.
void check_system(const Simulation& simulation, Index dimension);

/// Throws Error as share_step does, at less cost: for the first step of a run, before anything is written.
void check_next_step(const Simulation& simulation);

/// The next step of a simulation with all its contacts. Throws Error as prepare_step, and naming both bodies if two
/// overlap by more than `largest_overlap`, and for a system of another dimension than D.
template <int D>
StepProblem<D> checked_problem(const Simulation& simulation);

/// Whether a step is partitioned afresh, which happens every `redecompose` steps.
bool decomposes_afresh(const Simulation& simulation, Index step);

/// Subdomains of a step: 1 where the algorithm does not decompose.
Index subdomains_of_step(const Simulation& simulation);

/// The subdomain of each contact of a step. Between two fresh partitions known contacts keep their subdomain. A process
/// knows only those of its own subdomains: for a pair that lies wholly in others it may return any of these others. All
/// processes take part. The simulation must outlive the result.
using SubdomainOfContact = std::function<Index(const StepContact&)>;
template <int D>
SubdomainOfContact subdomain_of_contact(const Simulation& simulation);

/// The partition of the contacts of a step, or of those that this process has.
Partition partition_of(const SubdomainOfContact& subdomain, Index subdomains, const std::vector<StepContact>& contacts);
template <int D>
Partition partition_step(const Simulation& simulation, const StepProblem<D>& problem);

/// What is remembered of contacts, ascending by (a, b), and of their partition.
std::vector<RememberedSubdomain> subdomains_to_remember(const std::vector<StepContact>& contacts,
                                                        const Partition& partition);

}  // namespace nscdd
