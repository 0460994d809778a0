// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_problem.hpp"
#include "simulation/step_partition.hpp"
#include "simulation/step_report.hpp"

namespace nscdd {

/// What a process knows of a shared step in addition to the contacts of its own subdomains. Both are empty if one
/// process has the whole step.
struct ShareOfStep {
  std::vector<Index> process_of_subdomain = {};  ///< see deal_out
  std::vector<RememberedImpulse> impulses = {};  ///< of the step before at these contacts, among others
};

/// The next step of a simulation before it is decomposed. Each of several processes has the contacts of its own
/// subdomains, and their grains. Positions and velocities of all grains are replicated; every process visits all
/// contacts, one after the other, and keeps its own.
template <int D>
struct StepShare {
  StepProblem<D> problem;
  Partition partition;  ///< of its contacts
  ShareOfStep share;
  StepReport report;  ///< what is known by now: number and scale of the contacts of all processes
};

/// All processes take part; a single one, too. With every fresh partition subdomains are assigned to processes anew, by
/// their numbers of contacts, and impulses to start from are sent to the processes that need them. Throws Error as
/// checked_problem does, for more processes than subdomains, for an algorithm that processes cannot share, and if they
/// do not find the same contacts.
template <int D>
StepShare<D> share_step(const Simulation& simulation);

/// The step with all its contacts, whatever processes share.
template <int D>
StepProblem<D> whole_step(const Simulation& simulation);

/// Sums over all contacts of a step, added up subdomain by subdomain, see ContactSums. add(k, sums) adds what
/// contact k of this process brings to the sums, `quantities` of them.
template <class Add>
Vector sums_over_contacts(const Partition& partition, Index quantities, const Processes& processes, Add&& add) {
  return ContactSums(partition.subdomain_of_contact, partition.subdomains, processes)
      .add_up(quantities, count(partition.subdomain_of_contact), add);
}

/// How well contacts obey their law at the velocities of the bodies, added up subdomain by subdomain.
template <int D>
ContactResidual residual_of_subdomains(const ContactLaw& law, const Partition& partition,
                                       const std::vector<GrainContact<D>>& contacts,
                                       const std::vector<GrainVelocity<D>>& velocities, const Processes& processes);

/// The grains that several subdomains share, in whatever process, ascending.
std::vector<Index> shared_grains(const Interface& interface);

/// The contacts of a step to be remembered, ascending by (a, b). Each of several processes has those of its own
/// subdomains and all contacts of shared grains, so that it knows every contact of its own grains.
/// `shared`: grains that are shared, ascending.
template <int D>
std::vector<RememberedSubdomain> subdomains_to_remember(const StepProblem<D>& problem, const Partition& partition,
                                                        const std::vector<Index>& shared, const Processes& processes);

/// The velocities of all grains at the end of a step, those that touch nothing included. `velocities`: of the bodies of
/// the problem. Each of several processes knows those of its own contacts.
template <int D>
std::vector<GrainMotion> velocities_of_grains(const Simulation& before, const StepProblem<D>& problem,
                                              const std::vector<GrainVelocity<D>>& velocities,
                                              const Processes& processes);

}  // namespace nscdd
