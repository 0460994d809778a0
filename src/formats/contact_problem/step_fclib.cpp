// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/contact_problem/step_fclib.hpp"

#include "core/fail.hpp"
#include "mechanics/contact_blocks.hpp"
#include "two_stage/granular_two_stage.hpp"

#include <fmt/ranges.h>

#include <set>

namespace nscdd {
namespace {

// The step as the run prepared it, without impulses for a warm start.
template <int D>
StepProblem<D> next_problem(const Simulation& before) {
  const Interaction& interaction = before.dynamics.interaction;
  if (const auto law = to_string(interaction.law); law != Coulomb::name && law != Frictionless::name)
    fail("interaction.law: expected coulomb or frictionless, the laws of FCLIB, met {}", law);
  return prepare_step<D>(start_of(before), false);
}

template <int D>
void require_same_contacts(const StepProblem<D>& problem, const TrajectoryStep& after) {
  const auto kept = [](const TrajectoryContact& contact) { return body_pair(contact.geometry); };
  if (!std::ranges::equal(problem.geometry, after.contacts, {}, body_pair, kept))
    fail(
        "step {}: expected the {} contacts that the run found, met others ({}) from the state before: the trajectory "
        "is damaged or was written by a program that finds them otherwise",
        after.state.step, after.contacts.size(), problem.geometry.size());
}

template <int D>
Vector impulses_of(const TrajectoryStep& step, const std::vector<Index>& contacts) {
  Vector r(D * count(contacts));
  for (Index k = 0; k < count(contacts); ++k)
    set_component<D>(r, k, step.contacts[at(contacts[at(k)])].template local<D>());
  return r;
}

template <int D>
Vector velocities_of_free(const GranularSystem& system, const GranularState& state) {
  std::vector<double> v;
  for (Index i = 0; i < system.grains(); ++i) {
    if (!system.free(i)) continue;
    const GrainUnknowns<D> own =
        unknowns(with_motion<D>(motion_of(state, at(i), 1), 0));  // a radius of 1 m: spins, not rim velocities
    v.insert(v.end(), own.begin(), own.end());
  }
  return Vector::Map(v.data(), count(v));
}

FclibSolution solution_of(const GlobalFrictionProblem& problem, const Vector& v, const Vector& r) {
  return {v, problem.h.transpose() * v + problem.w, r};
}

Partition partition_of(const TrajectoryStep& step) {
  Partition partition{.subdomains = 1, .subdomain_of_contact = {}};
  for (const TrajectoryContact& contact : step.contacts) {
    partition.subdomain_of_contact.push_back(contact.subdomain);
    partition.subdomains = std::max(partition.subdomains, contact.subdomain + 1);
  }
  return partition;
}

// Bodies ascend by their numbers, not in the order of a sweep.
template <int D>
GranularSubdomain<D> with_ascending_bodies(const GranularSubdomain<D>& part) {
  std::vector<Index> order = natural_order(count(part.bodies));
  std::ranges::sort(order, {}, [&](Index i) { return part.bodies[at(i)]; });
  GranularSubdomain<D> result = part;
  std::vector<std::int32_t> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    result.bodies[k] = part.bodies[at(order[k])];
    result.velocities[k] = part.velocities[at(order[k])];
    place[at(order[k])] = static_cast<std::int32_t>(k);
  }
  for (ContactRow<D>& row : result.contacts.rows) {
    row.a = place[at(row.a)];
    row.b = place[at(row.b)];
  }
  return result;
}

// - A_E^T F, rim impulses as moments: the rim moves by R times the spin.
template <int D>
void add_interface_impulses(GlobalFrictionProblem& problem, const GranularSubdomain<D>& part,
                            const std::function<std::array<double, 3>(Index)>& rims,
                            const std::vector<RememberedGluing>& gluing, Index subdomain) {
  Index row = 0;
  for (std::size_t i = 0; i < part.bodies.size(); ++i) {
    if (part.velocities[i].inverse_mass == 0) continue;
    const Index grain = part.bodies[i];
    const auto own = [&](const RememberedGluing& one) { return std::pair(one.grain, one.subdomain); };
    const auto one = std::ranges::lower_bound(gluing, std::pair(grain, subdomain), {}, own);
    if (one != gluing.end() && own(*one) == std::pair(grain, subdomain))
      for (Index k = 0; k < unknowns_of_grain<D>; ++k)
        problem.f[row + k] -= (k < D ? 1 : rims(static_cast<Index>(i))[at(D == 2 ? k : k - D)]) * one->impulse[at(k)];
    row += unknowns_of_grain<D>;
  }
}

}  // namespace

FclibFile fclib_of_step(const Simulation& before, const TrajectoryStep* after) {
  return in_dimension(before.system, [&](auto dimension) {
    constexpr int D = dimension();
    const StepProblem<D> step = next_problem<D>(before);
    GlobalFrictionProblem problem = friction_problem(
        step.free, step.contacts, [&](Index body) { return before.system.rims(step.numbers[at(body)]); });
    FclibFile file;
    if (after != nullptr) {
      require_same_contacts(step, *after);
      const Vector r = impulses_of<D>(*after, natural_order(count(step.contacts)));
      // A state has the velocities of bodies after their turn.
      const bool grains = before.system.free_bodies.empty();
      file.solution = solution_of(
          problem, grains ? velocities_of_free<D>(before.system, after->state) : body_velocities(problem, r), r);
    }
    file.problem = std::move(problem);
    return file;
  });
}

FclibFile fclib_of_subdomain(const Simulation& before, const TrajectoryStep& after, Index subdomain) {
  return in_dimension(before.system, [&](auto dimension) {
    constexpr int D = dimension();
    const StepProblem<D> step = next_problem<D>(before);
    require_same_contacts(step, after);
    const Partition partition = partition_of(after);
    const std::set<Index> all(partition.subdomain_of_contact.begin(), partition.subdomain_of_contact.end());
    if (!all.contains(subdomain))
      fail("step {}: expected a subdomain that has contacts ({}), met {}", after.state.step,
           all.empty() ? "none has" : fmt::format("{}", fmt::join(all, ", ")), subdomain);
    const GranularDecomposition<D> parts =
        decompose(step, partition, ContactOrder::natural, 0, {}, {}, copy_mass(before.dynamics.solver));
    const GranularSubdomain<D> part = with_ascending_bodies(parts.subdomains[at(subdomain)]);
    std::vector<GrainContact<D>> contacts;
    for (std::size_t k = 0; k < part.contacts.size(); ++k)
      contacts.push_back(part.contacts.contact(k, part.velocities));
    const auto rims = [&](Index body) { return before.system.rims(step.numbers[at(part.bodies[at(body)])]); };
    GlobalFrictionProblem problem = friction_problem(part.velocities, contacts, rims);
    add_interface_impulses(problem, part, rims, after.state.gluing, subdomain);
    const Vector r = impulses_of<D>(after, part.numbers);
    FclibSolution solution = solution_of(problem, body_velocities(problem, r), r);
    return FclibFile{.problem = std::move(problem), .info = {}, .solution = std::move(solution), .guesses = {}};
  });
}

FclibFile local_form(FclibFile file) {
  if (const auto* global = std::get_if<GlobalFrictionProblem>(&file.problem)) file.problem = reduce(*global);
  if (file.solution) file.solution->v = {};
  return file;
}

FclibFile with_result(FclibFile file, const FrictionSolution& found) {
  if (found.status == FrictionStatus::not_finite) return file;
  FclibSolution result{{}, found.state.velocities, found.impulses};
  if (const auto* global = std::get_if<GlobalFrictionProblem>(&file.problem))
    result.v = body_velocities(*global, found.impulses);
  if (found.status == FrictionStatus::converged)
    file.solution = std::move(result);
  else
    file.guesses.push_back(std::move(result));
  return file;
}

}  // namespace nscdd
