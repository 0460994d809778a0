// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include "simulation/step_report.hpp"

namespace nscdd {

/// The next step of a simulation: prepared (share_step), then solved (solve_step), not yet taken. Each rank has the
/// contacts of its own subdomains, and their grains.
template <int D>
struct GranularStep {
  StepProblem<D> problem;
  Partition partition;                      ///< of its contacts
  std::vector<Index> process_of_subdomain;  ///< see deal_out; empty for a single rank
  std::vector<RememberedImpulse> impulses;  ///< of the step before, at least at these contacts; empty likewise
  std::vector<Index> shared_grains;         ///< those of several subdomains, on any ranks, ascending
  StepReport report;
  // Of a solved step:
  std::vector<GrainContact<D>> contacts;     ///< with their impulses
  std::vector<GrainVelocity<D>> velocities;  ///< of the bodies of the problem
  std::vector<GrainMotion> all_grains;       ///< velocities of all grains, then of free bodies
  ContactWork work;                          ///< of all contacts
  std::vector<RememberedGluing> gluing;
  std::vector<RememberedModel> models;
  Vector interface_impulses;
  bool bond_parts = false;       ///< a bond opens or slides, however large its shift
  bool energy_exploded = false;  ///< it ends with far more energy than loads, boundaries and pushes can bring
};

/// Prepares a step, on all ranks together. Positions and velocities of all grains are replicated; every rank visits all
/// contacts and keeps its own. Every fresh partition assigns subdomains to ranks by their numbers of contacts, and
/// sends the impulses to start from to their ranks. The report has the number and the scale of all contacts. Throws
/// Error as whole_step, for more ranks than subdomains, an algorithm for one rank, and contacts that differ on ranks.
template <int D>
GranularStep<D> share_step(const Simulation& simulation);

/// The step with all its contacts on every rank. Throws Error as prepare_step, naming both bodies if two overlap by
/// more than `largest_overlap`, and for a system of another dimension than D.
template <int D>
StepProblem<D> whole_step(const Simulation& simulation);

/// Throws Error as share_step does, at less cost: for the first step of a run, before anything is written.
void check_next_step(const Simulation& simulation);

/// Whether a step is partitioned afresh, as every `redecompose` steps. In between known contacts keep their subdomain.
bool decomposes_afresh(const Simulation& simulation, Index step);

/// The partition of contacts of the next step. All ranks call it together.
Partition partition_step(const Simulation& simulation, const std::vector<StepContact>& contacts);

/// The packing of the free ones among the first `grains`, now or, at their velocities, after the time `later`, s; with
/// `bodies` also of bodies that are free along all directions, as clumps with the masses of the bodies.
Packing free_grains(const GranularSystem& system, const GranularState& state, Index grains, double later = 0,
                    bool bodies = false);

/// The record of contacts, ascending by (a, b), and their partition.
std::vector<RememberedSubdomain> subdomains_to_remember(const std::vector<StepContact>& contacts,
                                                        const Partition& partition);

}  // namespace nscdd
