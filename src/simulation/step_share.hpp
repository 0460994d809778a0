// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_problem.hpp"
#include "simulation/dynamics.hpp"
#include "simulation/step_report.hpp"

namespace nscdd {

/// The next step of a simulation: prepared (share_step), then solved (solve_step), not yet taken. Each of several
/// processes has the contacts of its own subdomains, and their grains.
template <int D>
struct GranularStep {
  StepProblem<D> problem;
  Partition partition;                      ///< of its contacts
  std::vector<Index> process_of_subdomain;  ///< see deal_out; empty if one process has the whole step
  std::vector<RememberedImpulse> impulses;  ///< of the step before at these contacts, among others; empty likewise
  std::vector<Index> shared_grains;         ///< those that several subdomains hold, in whatever process, ascending
  StepReport report;                        ///< what is known by now
  // Of a solved step:
  std::vector<GrainContact<D>> contacts;     ///< with their impulses
  std::vector<GrainVelocity<D>> velocities;  ///< of the bodies of the problem
  std::vector<GrainMotion> all_grains;       ///< velocities of all grains
  ContactWork work;                          ///< of all contacts
  std::vector<RememberedGluing> gluing;
  std::vector<RememberedModel> models;
  Vector interface_impulses;
  bool energy_exploded = false;  ///< it ends with far more energy than loads, boundaries and pushes can bring
};

/// Prepares a step. All processes take part; a single one, too. Positions and velocities of all grains are replicated;
/// every process visits all contacts, one after the other, and keeps its own. With every fresh partition subdomains are
/// assigned to processes anew, by their numbers of contacts, and impulses to start from are sent to the processes that
/// need them. The report has the number and the scale of the contacts of all processes. Throws Error as whole_step
/// does, for more processes than subdomains, for an algorithm that processes cannot share, and if they do not find the
/// same contacts.
template <int D>
GranularStep<D> share_step(const Simulation& simulation);

/// The step with all its contacts, whatever processes share. Throws Error as prepare_step, naming both bodies if two
/// overlap by more than `largest_overlap`, and for a system of another dimension than D.
template <int D>
StepProblem<D> whole_step(const Simulation& simulation);

/// Throws Error as share_step does, at less cost: for the first step of a run, before anything is written.
void check_next_step(const Simulation& simulation);

/// Whether a step is partitioned afresh, which happens every `redecompose` steps. Between two fresh partitions known
/// contacts keep their subdomain.
bool decomposes_afresh(const Simulation& simulation, Index step);

/// The partition of contacts of the next step. All processes take part.
Partition partition_step(const Simulation& simulation, const std::vector<StepContact>& contacts);

/// The free grains among the first so many, at rest where they are, or would be after a time `later`, s, at their
/// velocities: those of a packing without what boundaries drive.
Packing free_grains(const GranularSystem& system, const GranularState& state, Index grains, double later = 0);

/// What is remembered of contacts, ascending by (a, b), and of their partition.
std::vector<RememberedSubdomain> subdomains_to_remember(const std::vector<StepContact>& contacts,
                                                        const Partition& partition);

/// Sums over all contacts of a step, added up subdomain by subdomain, see ContactSums. add(k, sums) adds what
/// contact k of this process brings to the sums, `quantities` of them.
template <class Add>
Vector sums_over_contacts(const Partition& partition, Index quantities, const Processes& processes, Add&& add) {
  return ContactSums(partition.subdomain_of_contact, partition.subdomains, processes)
      .add_up(quantities, count(partition.subdomain_of_contact), add);
}

}  // namespace nscdd
