// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/step_share.hpp"

#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"
#include "packing/grain_grid.hpp"

namespace nscdd {
namespace {

// The subdomain of each contact of a step. For a contact of another rank it may return any subdomain of other ranks.
// All ranks make it together. The simulation must outlive it.
using SubdomainOfContact = std::function<Index(const StepContact&)>;

// The subdomain of a contact if it is among the known ones, ascending by (a, b); otherwise -1.
Index known_subdomain(const std::vector<RememberedSubdomain>& known, const StepContact& c) {
  const auto found = std::ranges::lower_bound(known, body_pair(c), {}, body_pair);
  return found != known.end() && body_pair(*found) == body_pair(c) ? found->subdomain : -1;
}

// The subdomain of a midpoint, by the centres of the grains that move freely, where contacts are found.
auto subdomain_of_point(const auto& partitioner, const Simulation& simulation) {
  const TimeStepping& time = simulation.dynamics.time;
  return subdomain_of_midpoint(partitioner, free_grains(simulation.system, simulation.state, simulation.system.grains(),
                                                        (1 - time.theta) * time.step, true));
}

SubdomainOfContact fresh_subdomains(const Simulation& simulation) {
  const auto by = [&](const auto& partitioner) -> SubdomainOfContact {
    if constexpr (std::decay_t<decltype(partitioner)>::needs_geometry)
      return [subdomain = subdomain_of_point(partitioner, simulation)](const StepContact& c) {
        return subdomain(c.point);
      };
    else
      return in_dimension(simulation.system, [&](auto dimension) -> SubdomainOfContact {
        const auto problem = prepare_step<dimension()>(start_of(simulation), false);
        // Normal directions alone: a graph needs only to know which contacts share a grain.
        ReferenceProblem graph = reference_problem(problem, simulation.system.bodies());
        std::vector<Index> normals;
        for (Index c = 0; c < count(problem.contacts); ++c) normals.push_back(dimension() * c);
        graph.h = selected_columns(graph.h, normals);
        const Partition of_contacts = partition(partitioner, graph);
        return [known = subdomains_to_remember(problem.geometry, of_contacts)](const StepContact& c) {
          return known_subdomain(known, c);
        };
      });
  };
  return std::visit(by, simulation.partitioner);
}

// Known contacts stay in their subdomain. A new one goes to the subdomain of a known one that shares a free grain.
SubdomainOfContact kept_subdomains(const Simulation& simulation) {
  const GranularSystem& system = simulation.system;
  const std::vector<RememberedSubdomain>& known = simulation.state.subdomains;
  std::vector<double> of_grain(at(system.bodies()), -1);
  for (const RememberedSubdomain& one : known)
    for (const Index i : {system.node_of(one.a), system.node_of(one.b)})
      if (system.is_free_node(i) && of_grain[at(i)] < 0) of_grain[at(i)] = static_cast<double>(one.subdomain);
  // A rank knows all contacts of the grains of its own subdomains, and none of other grains.
  simulation.processes.largest(of_grain);
  return [&system, &known,
          of_grain = std::vector<std::int32_t>(of_grain.begin(), of_grain.end())](const StepContact& c) -> Index {
    if (const Index subdomain = known_subdomain(known, c); subdomain >= 0) return subdomain;
    const Index a = system.node_of(c.a), b = system.node_of(c.b);
    if (of_grain[at(a)] >= 0) return of_grain[at(a)];
    return b >= 0 ? std::max(of_grain[at(b)], 0) : 0;
  };
}

Index subdomains_of_step(const Simulation& simulation) {
  return decomposes(simulation.dynamics.solver.algorithm) ? subdomains(simulation.partitioner) : 1;
}

SubdomainOfContact subdomain_of_contact(const Simulation& simulation) {
  if (!decomposes(simulation.dynamics.solver.algorithm)) return [](const StepContact&) { return Index{0}; };
  return decomposes_afresh(simulation, simulation.state.step) ? fresh_subdomains(simulation)
                                                              : kept_subdomains(simulation);
}

Partition partition_of(const SubdomainOfContact& subdomain, Index subdomains,
                       const std::vector<StepContact>& contacts) {
  Partition partition{.subdomains = subdomains, .subdomain_of_contact = std::vector<Index>(contacts.size())};
  std::ranges::transform(contacts, partition.subdomain_of_contact.begin(), subdomain);
  return partition;
}

// Throws Error for a system of another dimension, and naming the grain if a contact solver cannot take its mass.
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

// The wanted impulses of the last step, ascending by (a, b). Each rank has its own, but at the start of a run all.
std::vector<RememberedImpulse> impulses_of_all(const Simulation& simulation, const auto& wanted) {
  const GranularState& state = simulation.state;
  if (state.process_of_subdomain.empty()) return state.impulses;
  std::vector<RememberedImpulse> found;
  simulation.processes.exchange(state.impulses, [&](std::span<const RememberedImpulse> given) {
    std::ranges::copy_if(given, std::back_inserter(found), wanted);
  });
  std::ranges::sort(found, {}, body_pair);
  return found;
}

// The rank of each subdomain, by numbers of contacts and shared free grains; empty for a single rank.
template <int D>
std::vector<Index> dealt_out(const Simulation& simulation, const SubdomainOfContact& subdomain) {
  if (simulation.processes.alone()) return {};
  const GranularSystem& system = simulation.system;
  std::vector<std::vector<Index>> shared(at(subdomains(simulation.partitioner)));
  std::vector<Index> weight(shared.size(), 1);
  std::vector<std::int32_t> first(at(system.bodies()), -1);  // subdomain that first met a body
  const auto meet = [&](Index body, Index e) {
    const Index grain = system.node_of(body);
    if (!system.is_free_node(grain)) return;
    std::int32_t& known = first[at(grain)];
    if (known < 0) known = static_cast<std::int32_t>(e);
    if (known == e) return;
    shared[at(known)].push_back(grain);
    shared[at(e)].push_back(grain);
  };
  for_each_step_contact(start_of(simulation), [&](const StepContact& c) {
    const Index e = subdomain(c);
    ++weight[at(e)];
    meet(c.a, e);
    meet(c.b, e);
  });
  std::vector<std::span<const Index>> held;
  for (std::vector<Index>& grains : shared) {
    sort_unique(grains);
    held.emplace_back(grains);
  }
  return deal_out(Interface(unknowns_of_grain<D>, system.bodies(), held), weight, simulation.processes.size);
}

// The grains and free bodies of the problem of some contacts, ascending: those that they touch, or all.
std::vector<std::int32_t> bodies_of(const std::vector<StepContact>& contacts, const GranularSystem& system, bool all) {
  if (all) return natural_order<std::int32_t>(system.bodies());
  std::vector<std::int32_t> numbers;
  for (const StepContact& c : contacts)
    for (const Index i : {system.node_of(c.a), system.node_of(c.b)})
      if (i >= 0) numbers.push_back(static_cast<std::int32_t>(i));
  sort_unique(numbers);
  return numbers;
}

// The scale is a mean over all contacts, added up subdomain by subdomain: no bit depends on the number of ranks.
template <int D>
void set_scale(GranularStep<D>& step, const Simulation& simulation, Index contacts) {
  const Vector sum = sums_over_contacts(step.partition, 1, simulation.processes, [&](Index k, auto&& own) {
    own[0] += 1 / inverse_normal_delassus(step.problem.contacts[at(k)]);
  });
  const double mean = sum[0] / std::max(1.0, static_cast<double>(contacts));
  set_scale(step.problem, simulation.dynamics.interaction, mean);
  step.report.contacts = contacts;
  step.report.scale = step.problem.scale;
}

}  // namespace

Packing free_grains(const GranularSystem& system, const GranularState& state, Index grains, double later, bool bodies) {
  const auto place = [&](const std::vector<double>& x, const std::vector<double>& velocity, Index i) {
    return later == 0 ? x[at(i)] : x[at(i)] + later * velocity[at(i)];
  };
  const auto in_body = [&](Index i) { return bodies && !system.free(i) && !system.is_boundary(i); };
  std::vector<double> sums(system.boundaries.size(), 0);  // of the masses of the grains of each
  for (Index i = 0; i < grains; ++i)
    if (in_body(i)) sums[at(system.driven_by[at(i)])] += system.mass[at(i)];
  Packing packing;
  for (Index i = 0; i < grains; ++i) {
    if (!system.free(i) && !in_body(i)) continue;
    const Index body = system.driven_by[at(i)];
    packing.x.push_back(place(state.x, state.velocity_x, i));
    packing.y.push_back(place(state.y, state.velocity_y, i));
    if (system.dimension == 3) packing.z.push_back(place(state.z, state.velocity_z, i));
    packing.radius.push_back(system.radius[at(i)]);
    const double scale = in_body(i) ? system.boundaries[at(body)].body->mass / sums[at(body)] : 1;
    packing.mass.push_back(scale * system.mass[at(i)]);
    if (bodies) packing.clump.push_back(body);
  }
  if (std::ranges::all_of(packing.clump, [](Index number) { return number < 0; })) packing.clump.clear();
  return packing;
}

template <int D>
GranularStep<D> share_step(const Simulation& simulation) {
  check_system(simulation, D);
  const auto& [system, state, dynamics, partitioner, all, inertia, bddc] = simulation;
  if (!all.alone() && (!decomposes(dynamics.solver.algorithm) || switches_models(simulation)))
    throw Error("processes: expected an algorithm that decomposes if several ranks share a step, met another");
  const Index subdomains = subdomains_of_step(simulation);
  require_subdomains(subdomains, all.size);
  const SubdomainOfContact subdomain = subdomain_of_contact(simulation);
  GranularStep<D> step;
  std::vector<Index>& process_of = step.process_of_subdomain = state.process_of_subdomain;
  const bool afresh = decomposes_afresh(simulation, state.step) || process_of.empty();
  if (afresh) process_of = dealt_out<D>(simulation, subdomain);
  std::vector<StepContact> own;
  own.reserve(at(3 * system.grains() / all.size));
  const StepStart start = start_of(simulation);
  const ConsideredContacts considered = for_each_step_contact(start, [&, rank = all.rank](const StepContact& c) {
    if (process_of.empty() || process_of[at(subdomain(c))] == rank) own.push_back(c);
  });
  // All ranks must call both reductions, also if some of them have found other contacts.
  const Index kept = all.sum(count(own)), most = all.maximum(considered.number),
              least = -all.maximum(-considered.number);
  if (kept != considered.number || most != least)
    throw Error("processes: expected the same step on all ranks, met different ones: their processors may differ");
  check_overlaps(start, considered.deep);
  own = sorted_by_bodies(own, system.grains());
  step.partition = partition_of(subdomain, subdomains, own);
  if (!all.alone())
    step.impulses = !afresh ? state.impulses : impulses_of_all(simulation, [&](const RememberedImpulse& one) {
      return std::ranges::binary_search(own, body_pair(one), {}, body_pair);
    });
  std::vector<std::int32_t> bodies = bodies_of(own, system, all.alone());
  const std::vector<RememberedImpulse>& impulses = all.alone() ? state.impulses : step.impulses;
  step.problem = all.together([&, warm = dynamics.solver.warm_start] {
    return step_of_contacts<D>(start, std::move(own), considered.boundary_speed, std::move(bodies), impulses, warm);
  });
  set_scale(step, simulation, considered.number);
  return step;
}

template <int D>
StepProblem<D> whole_step(const Simulation& simulation) {
  const Dynamics& dynamics = simulation.dynamics;
  check_system(simulation, D);
  GranularState state = simulation.state;
  state.impulses = impulses_of_all(simulation, [](const auto&) { return true; });
  return prepare_step<D>({simulation.system, state, dynamics.interaction, dynamics.time}, dynamics.solver.warm_start,
                         true);
}

void check_next_step(const Simulation& simulation) {
  const GranularSystem& system = simulation.system;
  const Dynamics& dynamics = simulation.dynamics;
  check_system(simulation, system.dimension);
  const StepStart start = start_of(simulation);
  check_overlaps(start, for_each_step_contact(start, [](const StepContact&) {}).deep);
  if (!decomposes(dynamics.solver.algorithm) || !decomposes_afresh(simulation, simulation.state.step)) return;
  const auto check_cells = [&](const auto& partitioner) {
    if constexpr (std::decay_t<decltype(partitioner)>::needs_geometry) subdomain_of_point(partitioner, simulation);
  };
  std::visit(check_cells, simulation.partitioner);
}

bool decomposes_afresh(const Simulation& simulation, Index step) {
  const Index last = simulation.state.decomposed_at;
  return last < 0 || step - last >= simulation.dynamics.solver.redecompose;
}

Partition partition_step(const Simulation& simulation, const std::vector<StepContact>& contacts) {
  return partition_of(subdomain_of_contact(simulation), subdomains_of_step(simulation), contacts);
}

std::vector<RememberedSubdomain> subdomains_to_remember(const std::vector<StepContact>& contacts,
                                                        const Partition& partition) {
  std::vector<RememberedSubdomain> result;
  for (std::size_t k = 0; k < contacts.size(); ++k)
    result.push_back({contacts[k].a, contacts[k].b, partition.subdomain_of_contact[k]});
  return result;
}

template GranularStep<2> share_step(const Simulation&);
template GranularStep<3> share_step(const Simulation&);
template StepProblem<2> whole_step(const Simulation&);
template StepProblem<3> whole_step(const Simulation&);

}  // namespace nscdd
