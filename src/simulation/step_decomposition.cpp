// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/step_decomposition.hpp"

#include "linalg/sparse_entries.hpp"
#include <nscdd/ddm/granular_decomposition.hpp>
#include <nscdd/ddm/optimal_eta.hpp>
#include <nscdd/mechanics/contact_residual.hpp>

#include <algorithm>

namespace nscdd {
namespace {

ContactNetwork network_of(const StepProblem& problem, Index disks) {
  ContactNetwork network;
  network.grains = disks;
  for (const StepContact& c : problem.geometry)
    network.contacts.push_back({c.a, c.b, c.normal, c.point, c.gap});
  return network;
}

// Free grains where contacts are found. The grid is laid over the box of their centres.
Packing free_grains(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme) {
  const double time = (1 - scheme.theta) * scheme.step;
  Packing packing;
  for (Index i = 0; i < system.disks(); ++i) {
    if (!system.free(i)) continue;
    packing.x.push_back(state.x[at(i)] + time * state.velocity_x[at(i)]);
    packing.y.push_back(state.y[at(i)] + time * state.velocity_y[at(i)]);
    packing.radius.push_back(system.radius[at(i)]);
  }
  return packing;
}

// The step problem with normal directions alone: METIS needs only to know which contacts share a grain.
ReferenceProblem normal_problem(const StepProblem& problem, Index disks) {
  ReferenceProblem result = reference_problem(problem, disks);
  std::vector<Index> normals;
  for (Index c = 0; c < count(problem.contacts); ++c) normals.push_back(2 * c);
  result.h = selected_columns(result.h, normals);
  return result;
}

// Keeps the columns of a contact that its status leaves in the linear problem.
void keep_columns(std::vector<char>& kept, std::size_t contact, ContactStatus status) {
  kept[2 * contact] = status != ContactStatus::open;
  kept[2 * contact + 1] = status == ContactStatus::stick;
}

// Columns that impulses may use: a contact without friction has no tangential one. Columns that no impulse
// can use would make Stage 2 too stiff, and the iterations diverge.
std::vector<char> usable_columns(const Simulation& simulation, const StepProblem& problem) {
  const bool always = !opens(contact_law(simulation.dynamics.interaction, problem.h));
  std::vector<char> kept(2 * problem.contacts.size(), 1);
  for (std::size_t k = 0; k < problem.contacts.size(); ++k)
    kept[2 * k + 1] = always || problem.contacts[k].friction > 0;
  return kept;
}

// M, H and the partition of a step for the linear analysis, restricted to the columns that impulses may use.
Decomposition linear_parts(const Simulation& simulation, const StepProblem& problem,
                           const Partition& partition) {
  Decomposition all =
      decompose(reference_problem(problem, simulation.system.disks()), partition_of_columns(partition));
  const std::vector<char> usable = usable_columns(simulation, problem);
  if (std::find(usable.begin(), usable.end(), 0) == usable.end()) return all;
  return restrict_contacts(all, usable);
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
  const Partition whole{.subdomains = 1,
                        .subdomain_of_contact = std::vector<Index>(problem.contacts.size(), 0)};
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

Partition fresh_partition(const Simulation& simulation, const StepProblem& problem) {
  const Index disks = simulation.system.disks();
  return distribute(
      simulation.partitioner,
      [&] {
        return std::pair(free_grains(simulation.system, simulation.state, simulation.dynamics.time),
                         network_of(problem, disks));
      },
      [&] { return normal_problem(problem, disks); });
}

// Known contacts stay in their subdomain. A new one goes to the subdomain of a known one that shares a free
// disk.
Partition kept_partition(const Simulation& simulation, const StepProblem& problem) {
  Partition partition = {.subdomains = subdomains(simulation.partitioner), .subdomain_of_contact = {}};
  const auto& known = simulation.state.subdomains;
  std::vector<Index> of_disk(problem.free.size(), -1);
  for (const RememberedSubdomain& one : known)
    for (const Index i : {one.a, one.b})
      if (i < simulation.system.disks() && simulation.system.free(i) && of_disk[at(i)] < 0)
        of_disk[at(i)] = one.subdomain;
  auto old = known.begin();
  for (const StepContact& c : problem.geometry) {
    const auto key = std::pair(c.a, c.b);
    while (old != known.end() && std::pair(old->a, old->b) < key) ++old;
    Index subdomain = of_disk[at(c.a)];
    if (old != known.end() && std::pair(old->a, old->b) == key)
      subdomain = old->subdomain;
    else if (subdomain < 0 && c.b < simulation.system.disks())
      subdomain = of_disk[at(c.b)];
    partition.subdomain_of_contact.push_back(std::max<Index>(subdomain, 0));
  }
  return partition;
}

}  // namespace

Partition partition_step(const Simulation& simulation, const StepProblem& problem) {
  const StepSolver& solver = simulation.dynamics.solver;
  if (solver.algorithm == StepAlgorithm::nlgs)
    return {.subdomains = 1, .subdomain_of_contact = std::vector<Index>(problem.contacts.size(), 0)};
  return decomposes_afresh(simulation, simulation.state.step) ? fresh_partition(simulation, problem)
                                                              : kept_partition(simulation, problem);
}

bool decomposes_afresh(const Simulation& simulation, Index step) {
  const Index last = simulation.state.decomposed_at;
  return last < 0 || step - last >= simulation.dynamics.solver.redecompose;
}

InterfaceOperator enriched_operator(const Simulation& simulation, const StepProblem& problem,
                                    const Partition& partition, double eta) {
  const Decomposition all = linear_parts(simulation, problem, partition);
  const StepSolver& solver = simulation.dynamics.solver;
  if (solver.network == StageTwoNetwork::active ||
      solver.enrichment == Enrichment::semi_implicit)  // frozen from the step before
    return InterfaceFamily(restrict_contacts(all, active_columns(simulation, problem))).at(eta);
  return InterfaceFamily(all).at(eta);
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
