// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/step_share.hpp"

#include "core/fail.hpp"
#include "packing/grain_grid.hpp"
#include <nscdd/ddm/decomposition.hpp>

#include <numeric>
#include <set>

namespace nscdd {
namespace {

constexpr auto ends_of = [](const auto& contact) { return std::pair(contact.a, contact.b); };

// Impulses of the step before for which `wanted` says so, ascending by (a, b). Each process has those of its own
// subdomains; but at the beginning of a run all of them, of which no process is to be asked.
template <class Wanted>
std::vector<RememberedImpulse> impulses_of_all(const Simulation& simulation, const Wanted& wanted) {
  const GranularState& state = simulation.state;
  if (state.process_of_subdomain.empty()) return state.impulses;
  std::vector<RememberedImpulse> found;
  simulation.processes.exchange(state.impulses, [&](std::span<const RememberedImpulse> given) {
    std::ranges::copy_if(given, std::back_inserter(found), wanted);
  });
  std::ranges::sort(found, {}, ends_of);
  return found;
}

// Who has which subdomain: these are dealt out by the number of their contacts and by the free grains that they share.
// Nothing where one process has all.
template <int D>
std::vector<Index> dealt_out(const Simulation& simulation, const SubdomainOfContact& subdomain) {
  if (simulation.processes.alone()) return {};
  const GranularSystem& system = simulation.system;
  std::vector<std::vector<Index>> shared(at(subdomains(simulation.partitioner)));
  std::vector<Index> weight(shared.size(), 1);
  std::vector<std::int32_t> first(at(system.grains()), -1);  // subdomain in which a grain was met
  const auto meet = [&](Index grain, Index e) {
    if (grain >= system.grains() || !system.free(grain)) return;
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
    std::ranges::sort(grains);
    grains.erase(std::unique(grains.begin(), grains.end()), grains.end());
    held.emplace_back(grains);
  }
  return deal_out(Interface(unknowns_of_grain<D>, system.grains(), held), weight, simulation.processes.size);
}

// The grains of the problem of some contacts, ascending: those that they touch, or all if one process has all contacts.
std::vector<std::int32_t> grains_of(const std::vector<StepContact>& contacts, Index grains, bool all) {
  std::vector<std::int32_t> numbers;
  if (all) {
    numbers.resize(at(grains));
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
  }
  for (const StepContact& c : contacts)
    for (const Index i : {c.a, c.b})
      if (i < grains) numbers.push_back(static_cast<std::int32_t>(i));
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

// The scale is a mean over all contacts, added up subdomain by subdomain: no bit depends on the processes.
template <int D>
void set_scale(StepShare<D>& step, const Simulation& simulation, Index contacts) {
  const Vector sum = sums_over_contacts(step.partition, 1, simulation.processes, [&](Index k, auto&& own) {
    own[0] += 1 / step.problem.contacts[at(k)].inverse_w.inverse_n;
  });
  const double mean = sum[0] / std::max(1.0, static_cast<double>(contacts));
  set_scale(step.problem, simulation.dynamics.interaction, mean);
  step.report.contacts = contacts;
  step.report.scale = step.problem.scale;
}

}  // namespace

template <int D>
StepShare<D> share_step(const Simulation& simulation) {
  check_system(simulation, D);
  const auto& [system, state, dynamics, partitioner, all, inertia] = simulation;
  if (!all.alone() && (!decomposes(dynamics.solver.algorithm) || switches_models(simulation)))
    throw Error("processes: expected an algorithm that decomposes where several of them share a step, met another");
  const Index subdomains = subdomains_of_step(simulation);
  require_subdomains(subdomains, all.size);
  const SubdomainOfContact subdomain = subdomain_of_contact<D>(simulation);
  StepShare<D> step;
  std::vector<Index>& process_of = step.share.process_of_subdomain = state.process_of_subdomain;
  const bool afresh = decomposes_afresh(simulation, state.step) || process_of.empty();
  if (afresh) process_of = dealt_out<D>(simulation, subdomain);
  std::vector<StepContact> own;
  own.reserve(at(3 * system.grains() / all.size));
  const StepStart start = start_of(simulation);
  const ConsideredContacts considered = for_each_step_contact(start, [&, rank = all.rank](const StepContact& c) {
    if (process_of.empty() || process_of[at(subdomain(c))] == rank) own.push_back(c);
  });
  // All processes must come to both numbers, also where some have found others.
  const Index kept = all.sum(count(own)), most = all.maximum(considered.number),
              least = -all.maximum(-considered.number);
  if (kept != considered.number || most != least)
    throw Error("processes: expected the same step in all of them, met others: their processors may differ");
  check_overlaps(start, considered.deep);
  own = sorted_by_bodies(own, system.grains());
  step.partition = partition_of(subdomain, subdomains, own);
  if (!all.alone()) step.share.impulses = state.impulses;
  if (!all.alone() && afresh)
    step.share.impulses = impulses_of_all(simulation, [&](const RememberedImpulse& one) {
      return std::ranges::binary_search(own, std::pair(one.a, one.b), {}, ends_of);
    });
  std::vector<std::int32_t> grains = grains_of(own, system.grains(), all.alone());
  const std::vector<RememberedImpulse> none, &last = all.alone() ? state.impulses : step.share.impulses;
  step.problem = step_of_contacts<D>(start, std::move(own), considered.boundary_speed, std::move(grains),
                                     dynamics.solver.warm_start ? last : none);
  set_scale(step, simulation, considered.number);
  return step;
}

template <int D>
StepProblem<D> whole_step(const Simulation& simulation) {
  const Dynamics& dynamics = simulation.dynamics;
  GranularState state = simulation.state;
  if (dynamics.solver.warm_start) state.impulses = impulses_of_all(simulation, [](const auto&) { return true; });
  return prepare_step<D>({simulation.system, state, dynamics.interaction, dynamics.time}, dynamics.solver.warm_start);
}

std::vector<Index> shared_grains(const Interface& interface) {
  std::vector<Index> grains;
  for (const Gluing& row : interface.gluing())
    if (grains.empty() || grains.back() != row.grain) grains.push_back(row.grain);
  return grains;
}

template <int D>
std::vector<RememberedSubdomain> subdomains_to_remember(const StepProblem<D>& problem, const Partition& partition,
                                                        const std::vector<Index>& shared, const Processes& processes) {
  std::vector<RememberedSubdomain> known = subdomains_to_remember(problem.geometry, partition);
  std::set<Index> own;
  std::vector<RememberedSubdomain> given;
  const auto is_shared = [&](Index grain) { return std::ranges::binary_search(shared, grain); };
  for (const RememberedSubdomain& one : known) {
    own.insert(one.subdomain);
    if (is_shared(one.a) || is_shared(one.b)) given.push_back(one);
  }
  given = processes.gather(given);
  std::ranges::copy_if(given, std::back_inserter(known),
                       [&](const RememberedSubdomain& one) { return !own.contains(one.subdomain); });
  std::ranges::sort(known, {}, ends_of);
  return known;
}

template <int D>
ContactResidual residual_of_subdomains(const ContactLaw& law, const Partition& partition,
                                       const std::vector<GrainContact<D>>& contacts,
                                       const std::vector<GrainVelocity<D>>& velocities, const Processes& processes) {
  std::vector<std::vector<GrainContact<D>>> of_subdomain(at(partition.subdomains));
  for (std::size_t k = 0; k < contacts.size(); ++k)
    of_subdomain[at(partition.subdomain_of_contact[k])].push_back(contacts[k]);
  std::vector<ContactResidual> residuals;
  for (const auto& own : of_subdomain) residuals.push_back(contact_residual(law, own, velocities));
  return added_up(residuals, processes);
}

template <int D>
std::vector<GrainMotion> velocities_of_grains(const Simulation& before, const StepProblem<D>& problem,
                                              const std::vector<GrainVelocity<D>>& velocities,
                                              const Processes& processes) {
  const GranularSystem& system = before.system;
  const auto motions = step_motions(system, before.state, before.dynamics.time);
  std::vector<GrainMotion> result;
  result.reserve(at(system.grains()));
  for (Index i = 0; i < system.grains(); ++i) result.push_back(free_motion(start_of(before), motions, i));
  struct Moved {
    Index grain;
    GrainMotion velocity;
  };
  std::vector<Moved> own;
  for (std::size_t body = 0; body < velocities.size(); ++body)
    if (velocities[body].inverse_mass != 0) own.push_back({problem.numbers[body], motion_of(velocities[body])});
  processes.exchange(own, [&](std::span<const Moved> given) {
    for (const Moved& one : given) result[at(one.grain)] = one.velocity;
  });
  return result;
}

template ContactResidual residual_of_subdomains(const ContactLaw&, const Partition&,
                                                const std::vector<GrainContact<2>>&,
                                                const std::vector<GrainVelocity<2>>&, const Processes&);
template StepShare<2> share_step(const Simulation&);
template StepProblem<2> whole_step(const Simulation&);
template std::vector<RememberedSubdomain> subdomains_to_remember(const StepProblem<2>&, const Partition&,
                                                                 const std::vector<Index>&, const Processes&);
template std::vector<GrainMotion> velocities_of_grains(const Simulation&, const StepProblem<2>&,
                                                       const std::vector<GrainVelocity<2>>&, const Processes&);
template ContactResidual residual_of_subdomains(const ContactLaw&, const Partition&,
                                                const std::vector<GrainContact<3>>&,
                                                const std::vector<GrainVelocity<3>>&, const Processes&);
template StepShare<3> share_step(const Simulation&);
template StepProblem<3> whole_step(const Simulation&);
template std::vector<RememberedSubdomain> subdomains_to_remember(const StepProblem<3>&, const Partition&,
                                                                 const std::vector<Index>&, const Processes&);
template std::vector<GrainMotion> velocities_of_grains(const Simulation&, const StepProblem<3>&,
                                                       const std::vector<GrainVelocity<3>>&, const Processes&);

}  // namespace nscdd
