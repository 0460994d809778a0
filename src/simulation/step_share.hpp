// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/sum_of_parts.hpp"
#include "ddm/granular_two_stage.hpp"
#include "simulation/step_decomposition.hpp"

namespace nscdd {

/// What a process has of a step that several share: the contacts of its own subdomains, and their grains. Every process
/// knows where all grains are and how fast; it looks at all contacts, one after the other, and keeps its own.
template <int D>
struct StepShare {
  StepProblem<D> problem;
  Partition partition;  ///< of its contacts
  ShareOfStep of_step;  ///< empty where this process has all of the step
};

/// Whether processes share what a step holds. Contact solvers that cut their linear systems alone do not: every process
/// has all contacts.
bool shares_steps(const Simulation& simulation);

/// The processes that share a step; where each has all of it, this one alone.
Processes sharing(const Simulation& simulation, const ShareOfStep& share);

/// The share of the next step that this process has; all processes take part. Subdomains are dealt out afresh with
/// every fresh partition, by weight of their contacts, and impulses to start from go to the processes that need them
/// now. Throws Error as checked_problem does, for more processes than subdomains, and if processes do not find the same
/// contacts.
template <int D>
StepShare<D> share_step(const Simulation& simulation);

/// The step with all its contacts, whatever processes share.
template <int D>
StepProblem<D> whole_step(const Simulation& simulation);

/// Sums over all contacts of a step, added up subdomain by subdomain, see sum_of_parts. add(k, sums) adds what
/// contact k of this process brings to the sums, `quantities` of them.
template <class Add>
Vector sums_over_contacts(const Partition& partition, Index quantities, const Processes& processes, Add&& add) {
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(quantities, partition.subdomains);
  for (std::size_t k = 0; k < partition.subdomain_of_contact.size(); ++k)
    add(k, parts.col(partition.subdomain_of_contact[k]));
  return sum_of_parts(std::move(parts), processes);
}

/// What is to be remembered of the contacts of a step, ascending by (a, b). Of several processes each has those of its
/// own subdomains, and of the others those of grains that are shared, so that it knows all contacts of its own grains.
/// `gluing`: of the step, which tells what is shared.
template <int D>
std::vector<RememberedSubdomain> subdomains_to_remember(const StepProblem<D>& problem, const Partition& partition,
                                                        const std::vector<RememberedGluing>& gluing,
                                                        const Processes& processes);

/// The velocities of all grains at the end of a step, those that touch nothing included. `velocities`: of the bodies of
/// the problem. Each of several processes knows those of its own contacts.
template <int D>
std::vector<GrainUnknowns<D>> velocities_of_grains(const Simulation& before, const StepProblem<D>& problem,
                                                   const std::vector<GrainVelocity<D>>& velocities,
                                                   const Processes& processes);

}  // namespace nscdd
