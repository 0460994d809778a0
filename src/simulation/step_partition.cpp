// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"
#include "simulation/simulation.hpp"
#include "simulation/step_decomposition.hpp"

namespace nscdd {
namespace {

template <int D>
ContactNetwork network_of(const StepProblem<D>& problem, Index grains) {
  ContactNetwork network;
  network.grains = grains;
  network.dimension = D;
  for (const StepContact& c : problem.geometry) network.contacts.push_back({c.a, c.b, c.normal, c.point, c.gap});
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

template <int D>
Partition fresh_partition(const Simulation& simulation, const StepProblem<D>& problem) {
  const Index disks = simulation.system.disks();
  return distribute(
      simulation.partitioner,
      [&] {
        return std::pair(free_grains(simulation.system, simulation.state, simulation.dynamics.time),
                         network_of(problem, disks));
      },
      [&] { return normal_problem(problem, disks); });
}

// Known contacts stay in their subdomain. A new one goes to the subdomain of a known one that shares a free disk.
template <int D>
Partition kept_partition(const Simulation& simulation, const StepProblem<D>& problem) {
  Partition partition = {.subdomains = subdomains(simulation.partitioner), .subdomain_of_contact = {}};
  const auto& known = simulation.state.subdomains;
  std::vector<Index> of_disk(problem.free.size(), -1);
  for (const RememberedSubdomain& one : known)
    for (const Index i : {one.a, one.b})
      if (i < simulation.system.disks() && simulation.system.free(i) && of_disk[at(i)] < 0)
        of_disk[at(i)] = one.subdomain;
  const auto last = remembered(known, problem.geometry);
  for (std::size_t k = 0; k < last.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    Index subdomain = of_disk[at(c.a)];
    if (last[k] != nullptr)
      subdomain = last[k]->subdomain;
    else if (subdomain < 0 && c.b < simulation.system.disks())
      subdomain = of_disk[at(c.b)];
    partition.subdomain_of_contact.push_back(std::max<Index>(subdomain, 0));
  }
  return partition;
}

}  // namespace

template <int D>
StepProblem<D> checked_problem(const Simulation& simulation) {
  if (simulation.system.dimension != D)
    fail("simulation: expected {} here, met a system of {}", D == 2 ? "disks in the plane" : "spheres in space",
         simulation.system.dimension == 2 ? "disks in the plane" : "spheres in space");
  const Dynamics& dynamics = simulation.dynamics;
  StepProblem<D> problem = prepare_step<D>(simulation.system, simulation.state, dynamics.interaction, dynamics.time,
                                           dynamics.solver.warm_start);
  check_overlaps(simulation.system, problem.geometry, largest_overlap);
  for (std::size_t i = 0; is_contact_solver(dynamics.solver.algorithm) && i < problem.free.size(); ++i)
    if (!std::isfinite(problem.free[i].inverse_mass))
      fail("{}: expected a mass whose inverse is finite, met {} kg",
           body_name(simulation.system, static_cast<Index>(i)), simulation.system.mass[i]);
  return problem;
}

void check_next_step(const Simulation& simulation) {
  in_dimension(simulation.system,
               [&](auto dimension) { partition_step(simulation, checked_problem<dimension()>(simulation)); });
}

template <int D>
Partition partition_step(const Simulation& simulation, const StepProblem<D>& problem) {
  const StepSolver& solver = simulation.dynamics.solver;
  if (!decomposes(solver.algorithm)) return {.subdomain_of_contact = std::vector<Index>(problem.contacts.size(), 0)};
  return decomposes_afresh(simulation, simulation.state.step) ? fresh_partition(simulation, problem)
                                                              : kept_partition(simulation, problem);
}

bool decomposes_afresh(const Simulation& simulation, Index step) {
  const Index last = simulation.state.decomposed_at;
  return last < 0 || step - last >= simulation.dynamics.solver.redecompose;
}

template StepProblem<2> checked_problem(const Simulation&);
template Partition partition_step(const Simulation&, const StepProblem<2>&);
template StepProblem<3> checked_problem(const Simulation&);
template Partition partition_step(const Simulation&, const StepProblem<3>&);

}  // namespace nscdd
