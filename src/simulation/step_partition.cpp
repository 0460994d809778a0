// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/step_partition.hpp"

#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"
#include "two_stage/granular_decomposition.hpp"

namespace nscdd {
namespace {

// Free grains where contacts are found. The grid is laid over the box of their centres.
Packing free_grains(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme) {
  const double time = (1 - scheme.theta) * scheme.step;
  Packing packing;
  for (Index i = 0; i < system.grains(); ++i) {
    if (!system.free(i)) continue;
    packing.x.push_back(state.x[at(i)] + time * state.velocity_x[at(i)]);
    packing.y.push_back(state.y[at(i)] + time * state.velocity_y[at(i)]);
    if (system.dimension == 3) packing.z.push_back(state.z[at(i)] + time * state.velocity_z[at(i)]);
    packing.radius.push_back(system.radius[at(i)]);
  }
  return packing;
}

// The step problem with normal directions alone: METIS needs only to know which contacts share a grain.
template <int D>
ReferenceProblem normal_problem(const StepProblem<D>& problem, Index grains) {
  ReferenceProblem result = reference_problem(problem, grains);
  std::vector<Index> normals;
  for (Index c = 0; c < count(problem.contacts); ++c) normals.push_back(D * c);
  result.h = selected_columns(result.h, normals);
  return result;
}

// The subdomain of a contact among those that are known, ascending by (a, b); -1 of others.
Index known_subdomain(const std::vector<RememberedSubdomain>& known, const StepContact& c) {
  const auto found = std::ranges::lower_bound(known, std::pair(c.a, c.b), {},
                                              [](const RememberedSubdomain& one) { return std::pair(one.a, one.b); });
  return found != known.end() && found->a == c.a && found->b == c.b ? found->subdomain : -1;
}

template <int D>
SubdomainOfContact fresh_subdomains(const Simulation& simulation) {
  const auto& [system, state, dynamics, partitioner, processes, inertia] = simulation;
  if (const auto* grid = std::get_if<GridPartitioner>(&partitioner)) {
    const auto cell = cell_of_midpoint(*grid, free_grains(system, state, dynamics.time));
    return [cell](const StepContact& c) { return cell(c.point); };
  }
  // METIS partitions the graph of all contacts.
  const auto problem = prepare_step<D>(start_of(simulation), false);
  const Partition of_contacts =
      partition(std::get<MetisPartitioner>(partitioner), normal_problem(problem, system.grains()));
  return [known = subdomains_to_remember(problem.geometry, of_contacts)](const StepContact& c) {
    return known_subdomain(known, c);
  };
}

// Known contacts stay in their subdomain. A new one goes to the subdomain of a known one that shares a free grain.
SubdomainOfContact kept_subdomains(const Simulation& simulation) {
  const GranularSystem& system = simulation.system;
  const std::vector<RememberedSubdomain>& known = simulation.state.subdomains;
  std::vector<double> of_grain(at(system.grains()), -1);
  for (const RememberedSubdomain& one : known)
    for (const Index i : {one.a, one.b})
      if (i < system.grains() && system.free(i) && of_grain[at(i)] < 0)
        of_grain[at(i)] = static_cast<double>(one.subdomain);
  // A process knows all contacts of the grains of its own subdomains, and none of those of other grains.
  simulation.processes.largest(of_grain);
  return [&system, &known,
          of_grain = std::vector<std::int32_t>(of_grain.begin(), of_grain.end())](const StepContact& c) -> Index {
    if (const Index subdomain = known_subdomain(known, c); subdomain >= 0) return subdomain;
    if (of_grain[at(c.a)] >= 0) return of_grain[at(c.a)];
    return c.b < system.grains() ? std::max(of_grain[at(c.b)], 0) : 0;
  };
}

}  // namespace

void check_system(const Simulation& simulation, Index dimension) {
  const GranularSystem& system = simulation.system;
  if (system.dimension != dimension)
    fail("simulation: expected {} here, met a system of {}", dimension == 2 ? "disks in the plane" : "spheres in space",
         system.dimension == 2 ? "disks in the plane" : "spheres in space");
  if (!is_contact_solver(simulation.dynamics.solver.algorithm)) return;
  for (Index i = 0; i < system.grains(); ++i)
    if (const double mass = system.mass[at(i)]; system.free(i) && !std::isfinite(1 / mass))
      fail("{}: expected a mass whose inverse is finite, met {} kg", body_name(system, i), mass);
}

template <int D>
StepProblem<D> checked_problem(const Simulation& simulation) {
  check_system(simulation, D);
  return prepare_step<D>(start_of(simulation), simulation.dynamics.solver.warm_start, true);
}

void check_next_step(const Simulation& simulation) {
  const GranularSystem& system = simulation.system;
  const Dynamics& dynamics = simulation.dynamics;
  check_system(simulation, system.dimension);
  const StepStart start = start_of(simulation);
  check_overlaps(start, for_each_step_contact(start, [](const StepContact&) {}).deep);
  const auto* grid = std::get_if<GridPartitioner>(&simulation.partitioner);
  if (grid != nullptr && decomposes(dynamics.solver.algorithm) && decomposes_afresh(simulation, simulation.state.step))
    cell_of_midpoint(*grid, free_grains(system, simulation.state, dynamics.time));
}

std::vector<RememberedSubdomain> subdomains_to_remember(const std::vector<StepContact>& contacts,
                                                        const Partition& partition) {
  std::vector<RememberedSubdomain> result;
  for (std::size_t k = 0; k < contacts.size(); ++k)
    result.push_back({contacts[k].a, contacts[k].b, partition.subdomain_of_contact[k]});
  return result;
}

Index subdomains_of_step(const Simulation& simulation) {
  return decomposes(simulation.dynamics.solver.algorithm) ? subdomains(simulation.partitioner) : 1;
}

template <int D>
SubdomainOfContact subdomain_of_contact(const Simulation& simulation) {
  if (!decomposes(simulation.dynamics.solver.algorithm)) return [](const StepContact&) { return Index{0}; };
  return decomposes_afresh(simulation, simulation.state.step) ? fresh_subdomains<D>(simulation)
                                                              : kept_subdomains(simulation);
}

Partition partition_of(const SubdomainOfContact& subdomain, Index subdomains,
                       const std::vector<StepContact>& contacts) {
  Partition partition{.subdomains = subdomains, .subdomain_of_contact = {}};
  partition.subdomain_of_contact.reserve(contacts.size());
  std::ranges::transform(contacts, std::back_inserter(partition.subdomain_of_contact), subdomain);
  return partition;
}

template <int D>
Partition partition_step(const Simulation& simulation, const StepProblem<D>& problem) {
  return partition_of(subdomain_of_contact<D>(simulation), subdomains_of_step(simulation), problem.geometry);
}

bool decomposes_afresh(const Simulation& simulation, Index step) {
  const Index last = simulation.state.decomposed_at;
  return last < 0 || step - last >= simulation.dynamics.solver.redecompose;
}

template StepProblem<2> checked_problem(const Simulation&);
template SubdomainOfContact subdomain_of_contact<2>(const Simulation&);
template Partition partition_step(const Simulation&, const StepProblem<2>&);
template StepProblem<3> checked_problem(const Simulation&);
template SubdomainOfContact subdomain_of_contact<3>(const Simulation&);
template Partition partition_step(const Simulation&, const StepProblem<3>&);

}  // namespace nscdd
