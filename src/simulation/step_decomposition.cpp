// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/step_decomposition.hpp"

#include "ddm/granular_decomposition.hpp"
#include "mechanics/disk_contacts.hpp"
#include <nscdd/ddm/optimal_eta.hpp>

#include <algorithm>

namespace nscdd {
namespace {

// Keeps the columns of a contact that its status leaves in the linear problem.
void keep_columns(std::vector<char>& kept, std::size_t contact, ContactStatus status) {
  kept[2 * contact] = status != ContactStatus::open;
  kept[2 * contact + 1] = status == ContactStatus::stick;
}

// M, H and the partition of a step for the linear analysis, restricted to the columns that impulses may use: a
// contact without friction has no tangential one. Columns that no impulse can use would make Stage 2 too stiff,
// and the iterations diverge.
Decomposition linear_parts(const Simulation& simulation, const StepProblem& problem, const Partition& partition) {
  Decomposition all = decompose(reference_problem(problem, simulation.system.disks()), partition_of_columns(partition));
  const bool always = !opens(contact_law(simulation.dynamics.interaction, problem.h));
  std::vector<char> usable(2 * problem.contacts.size(), 1);
  for (std::size_t k = 0; k < problem.contacts.size(); ++k)
    usable[2 * k + 1] = always || problem.contacts[k].friction > 0;
  return std::ranges::count(usable, 0) == 0 ? all : restrict_contacts(all, usable);
}

// Columns of the contacts that carried an impulse in the last step: both directions of those that stuck, the
// normal one of those that slid. If there is no step before, all of them.
std::vector<char> active_columns(const Simulation& simulation, const StepProblem& problem) {
  std::vector<char> kept(2 * problem.contacts.size(), simulation.state.impulses.empty() ? 1 : 0);
  auto old = simulation.state.impulses.begin();
  const auto end = simulation.state.impulses.end();
  const ContactLaw law = contact_law(simulation.dynamics.interaction, problem.h);
  for (std::size_t k = 0; k < problem.contacts.size(); ++k) {
    const auto key = std::pair(problem.geometry[k].a, problem.geometry[k].b);
    while (old != end && std::pair(old->a, old->b) < key) ++old;
    if (old == end) break;
    if (std::pair(old->a, old->b) != key) continue;
    DiskContact contact = problem.contacts[k];
    contact.impulse_n = old->impulse.n;
    contact.impulse_t = old->impulse.t;
    keep_columns(kept, k, status_of(law, contact));
  }
  return kept;
}

// The network that some undecomposed sweeps find for this step. It is near enough to the one at its end to
// choose a flexibility by, and it is known for the first step too.
std::vector<char> expected_columns(const Simulation& simulation, const StepProblem& problem) {
  constexpr int sweeps = 100;
  const Partition whole{.subdomains = 1, .subdomain_of_contact = std::vector<Index>(problem.contacts.size(), 0)};
  GranularDecomposition parts = decompose(problem, whole, "natural", 0);
  GranularSubdomain& one = parts.subdomains.front();
  const ContactLaw law = contact_law(simulation.dynamics.interaction, problem.h);
  for (std::size_t k = 0; k < one.contacts.size(); ++k)
    apply_impulse(one.contacts.contact(k, one.velocities), one.contacts.impulses[k], one.velocities);
  for (int k = 0; k < sweeps; ++k) gauss_seidel_sweep(law, one.contacts, one.velocities);
  std::vector<char> kept(2 * problem.contacts.size());
  for (std::size_t k = 0; k < one.contacts.size(); ++k)
    keep_columns(kept, k, status_of(law, one.contacts.contact(k, one.velocities)));
  return kept;
}

}  // namespace

InterfaceOperator enriched_operator(const Simulation& simulation, const StepProblem& problem,
                                    const Partition& partition, double eta) {
  const Decomposition all = linear_parts(simulation, problem, partition);
  const StepSolver& solver = simulation.dynamics.solver;
  const bool active = solver.network == StageTwoNetwork::active || solver.enrichment == Enrichment::semi_implicit;
  return InterfaceFamily(active ? restrict_contacts(all, active_columns(simulation, problem)) : all).at(eta);
}

double best_eta(const Simulation& simulation, const StepProblem& problem, const Partition& partition) {
  const Decomposition all = linear_parts(simulation, problem, partition);
  const StepSolver& solver = simulation.dynamics.solver;
  const bool relaxed =
      solver.interface_method == InterfaceMethod::richardson;  // conjugate gradients choose their own steps
  const double stable = stable_eta(all, relaxed ? solver.interface_relaxation : 1.0);
  if (!decomposes_afresh(simulation, simulation.state.step) && simulation.state.eta > 0)
    return std::max(simulation.state.eta, stable);  // contacts have come since it was found
  return std::max(optimal_eta(all, restrict_contacts(all, expected_columns(simulation, problem))), stable);
}

}  // namespace nscdd
