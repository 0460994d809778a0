// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/step_contacts.hpp"
#include "packing/grain_grid.hpp"

#include <fmt/ranges.h>

#include <numeric>

namespace nscdd {
namespace {

template <int D>
GrainVelocity<D> driven_velocity(const Direction<D>& v) {
  GrainUnknowns<D> u{};
  std::copy(v.begin(), v.end(), u.begin());
  return with_unknowns(u, 0);
}

template <int D>
void check_moves(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                 const TimeStepping& scheme, Index grain, const GrainVelocity<D>& v) {
  const auto finite = [](double number) { return std::isfinite(number); };
  const auto name = [&] { return body_name(system, grain); };
  const Direction<D> centre = centre_of<D>(state, at(grain)), velocity = velocity_of<D>(v);
  if (!std::ranges::all_of(centre, finite))
    fail("{}: expected a finite position, met ({}) m", name(), fmt::join(centre, ", "));
  const double move = scheme.step * speed_of<D>(v), far = largest_move * system.radius[at(grain)];
  if (move <= far && std::isfinite(squared_rim(v))) return;
  const std::string expected = fmt::format(
      "{}: expected to move by at most {} of its radii in a step, met a velocity of ({}) m/s and a step of "
      "{} s",
      name(), largest_move, fmt::join(velocity, ", "), scheme.step);
  const double safe = safe_step<D>(system, state, interaction, scheme);
  if (safe > 0) fail("{}; dynamics.step: expected at most {:g} s", expected, safe);
  throw Error(expected);
}

// The velocity of a grain at the beginning of a step. The state knows that of a free one; a boundary gives those of
// the grains it drives.
template <int D>
GrainVelocity<D> start_velocity(const GranularSystem& system, const GranularState& state,
                                const std::vector<RigidVelocity>& motions, Index grain) {
  const std::size_t i = at(grain);
  const double radius = system.radius[i];
  if (system.driven_by[i] < 0) return with_unknowns(unknowns_of<D>(state, i, radius), 1 / system.mass[i]);
  const auto k = at(system.driven_by[i]);
  GrainVelocity<D> v = driven_velocity<D>(velocity_of_point(motions[k], state.poses[k], centre_of<D>(state, i)));
  if (system.boundaries[k].orientation != Orientation::turning) return v;
  if constexpr (D == 2) {
    v.rim = radius * motions[k].spin;
  } else {
    v.rim_x = radius * motions[k].spin_x;
    v.rim_y = radius * motions[k].spin_y;
    v.rim_z = radius * motions[k].spin;
  }
  return v;
}

// Where contacts of a step are found, q_m.
template <int D>
Configuration<D> where_contacts_are(const GranularSystem& system, const GranularState& state,
                                    const TimeStepping& scheme) {
  return middle<D>(system, state, step_motions(system, state, scheme), (1 - scheme.theta) * scheme.step);
}

// The law as far as it says which contacts there are and what they need, before its scale is known.
struct Touch {
  double friction = 0, boundary_friction = 0;
  bool pulls = false;
  double pull = 0;
};

Touch touch_of(const Interaction& interaction, double h) {
  Touch touch;
  const auto take_from = [&](const auto& law) {
    touch.friction = law.rubs ? interaction.friction : 0;
    touch.boundary_friction = law.rubs ? interaction.friction_at_boundaries() : 0;
    touch.pulls = law.pulls;
    touch.pull = law.pull();
  };
  std::visit(take_from, contact_law(interaction, h, 1));  // the scale matters to none of these
  return touch;
}

// The velocity of a wall under a contact, m/s.
template <int D>
GrainVelocity<D> wall_velocity(const GranularSystem& system, const Configuration<D>& where, const StepContact& c) {
  const auto boundary = at(where.walls[at(c.b - system.grains())].boundary);
  return driven_velocity<D>(velocity_of_point(where.motions[boundary], where.poses[boundary], narrowed<D>(c.point)));
}

// Adds one body per wall contact, which moves as the wall does under the grain. Returns the bodies of each contact.
template <int D>
std::vector<std::array<Index, 2>> add_wall_bodies(StepProblem<D>& problem, const GranularSystem& system,
                                                  const Configuration<D>& where) {
  std::vector<std::array<Index, 2>> bodies;
  bodies.reserve(problem.geometry.size());
  const Index grains = count(problem.numbers);
  for (const StepContact& c : problem.geometry) {
    const Index a = body_of(problem, c.a);
    if (c.b < system.grains()) {
      bodies.push_back({a, body_of(problem, c.b)});
      continue;
    }
    bodies.push_back({a, count(problem.free)});
    problem.free.push_back(wall_velocity<D>(system, where, c));
    problem.start.push_back(problem.free.back());
  }
  for (Index k = grains; k < count(problem.free); ++k)
    problem.numbers.push_back(static_cast<std::int32_t>(system.grains() + k - grains));
  return bodies;
}

bool touches(const GranularSystem& system, const StepContact& c) {
  return c.gap <= touching_gap * smaller_radius(system, c.a, c.b);
}

template <int D>
GrainContact<D> solver_contact(const StepContact& c, const std::array<Index, 2>& bodies, const StepProblem<D>& problem,
                               const Interaction& interaction, double correction, double push) {
  const GrainVelocity<D>&a = problem.free[at(bodies[0])], &b = problem.free[at(bodies[1])];
  const bool driven = a.inverse_mass == 0 || b.inverse_mass == 0;
  GrainContact<D> k{.a = static_cast<std::int32_t>(bodies[0]),
                    .b = static_cast<std::int32_t>(bodies[1]),
                    .normal = narrowed<D>(c.normal),
                    .inverse_w = grain_delassus(a, b),
                    .bias = {c.gap > 0 ? c.gap / problem.h : std::max(correction * c.gap / problem.h, -push), {}},
                    .friction = driven ? problem.boundary_friction : problem.friction};
  if (interaction.restitution > 0 || interaction.tangential_restitution > 0) {
    const LocalVector<D> before = relative_velocity(k, problem.start);
    if (interaction.restitution > 0) k.bias.n = interaction.restitution * std::min(0.0, before.n);
    k.bias.t = interaction.tangential_restitution * before.t;
  }
  return k;
}

}  // namespace

double push_speed(const TimeStepping& scheme, double smaller_radius, double boundary_speed) {
  if (scheme.maximum_push_speed >= 0) return scheme.maximum_push_speed;
  const double gravity = std::hypot(scheme.gravity[0], scheme.gravity[1], scheme.gravity[2]);
  return natural_push_speed * (std::sqrt(gravity * smaller_radius) + boundary_speed);
}

std::vector<RigidVelocity> step_motions(const GranularSystem& system, const GranularState& state,
                                        const TimeStepping& scheme) {
  return boundary_velocities(system, state.time + scheme.step / 2);
}

template <int D>
GrainVelocity<D> free_velocity(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme,
                               const std::vector<RigidVelocity>& motions, Index grain) {
  GrainVelocity<D> v = start_velocity<D>(system, state, motions, grain);
  if (!system.free(grain)) return v;
  const Direction<D> gravity = gravity_of<D>(scheme);
  v.x += scheme.step * gravity[0];
  v.y += scheme.step * gravity[1];
  if constexpr (D == 3) v.z += scheme.step * gravity[2];
  return v;
}

template <int D>
ConsideredContacts for_each_step_contact(const GranularSystem& system, const GranularState& state,
                                         const Interaction& interaction, const TimeStepping& scheme,
                                         const std::function<void(const StepContact&)>& visit) {
  const auto motions = step_motions(system, state, scheme);
  const auto velocity = [&](Index grain) { return free_velocity<D>(system, state, scheme, motions, grain); };
  ConsideredContacts considered;
  for (Index i = 0; i < system.grains(); ++i) {
    const GrainVelocity<D> v = velocity(i);
    check_moves<D>(system, state, interaction, scheme, i, v);
    if (v.inverse_mass == 0) considered.boundary_speed = std::max(considered.boundary_speed, speed_of<D>(v));
  }
  const Path<D> path = Path<D>::to_contacts(system, state, scheme);
  const Configuration<D>& where = path.places.back();
  const bool pulls = touch_of(interaction, scheme.step).pulls;
  // Bodies that hold each other are found however short the alert distance.
  const double hold = pulls ? touching_gap * *std::max_element(system.radius.begin(), system.radius.end()) : 0;
  for_each_contact<D>(
      system, path, [&](Index grain) { return velocity_of<D>(velocity(grain)); }, scheme, hold,
      interaction.restitution == 0,
      [&](const StepContact& c) {
        // With restitution a contact acts once it touches: the predicted gap would swallow the impact.
        if (interaction.restitution > 0 && c.gap > 0 && !(pulls && touches(system, c))) return;
        ++considered.number;
        if (c.b >= system.grains())
          considered.boundary_speed =
              std::max(considered.boundary_speed, speed_of<D>(wall_velocity<D>(system, where, c)));
        visit(c);
      },
      [&](const DeepOverlap& one) { considered.deep.push_back(one); });
  return considered;
}

template <int D>
StepProblem<D> step_of_contacts(const GranularSystem& system, const GranularState& state,
                                const Interaction& interaction, const TimeStepping& scheme,
                                std::vector<StepContact> geometry, double boundary_speed,
                                std::vector<std::int32_t> grains, const std::vector<RememberedImpulse>& last) {
  const auto motions = step_motions(system, state, scheme);
  const Touch touch = touch_of(interaction, scheme.step);
  StepProblem<D> problem;
  problem.h = scheme.step;
  problem.friction = touch.friction;
  problem.boundary_friction = touch.boundary_friction;
  problem.pulls = touch.pulls;
  problem.tangential_bias = interaction.tangential_restitution > 0;
  problem.geometry = std::move(geometry);
  problem.numbers = std::move(grains);
  for (const std::int32_t i : problem.numbers) {
    problem.start.push_back(start_velocity<D>(system, state, motions, i));
    problem.free.push_back(free_velocity<D>(system, state, scheme, motions, i));
  }
  const auto bodies = add_wall_bodies<D>(problem, system, where_contacts_are<D>(system, state, scheme));
  double scale = 0;
  problem.contacts.reserve(problem.geometry.size());
  for (std::size_t k = 0; k < problem.geometry.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    problem.contacts.push_back(solver_contact<D>(c, bodies[k], problem, interaction, scheme.penetration_correction,
                                                 push_speed(scheme, smaller_radius(system, c.a, c.b), boundary_speed)));
    if (problem.pulls && touches(system, c)) problem.contacts.back().pull = touch.pull;
    scale += 1 / problem.contacts.back().inverse_w.inverse_n;
  }
  set_scale(problem, interaction, scale / std::max(1.0, static_cast<double>(problem.contacts.size())));
  const auto impulses = remembered(last, problem.geometry);
  for (std::size_t k = 0; k < impulses.size(); ++k)
    if (impulses[k] != nullptr)
      problem.contacts[k].impulse = recalled<D>(impulses[k]->impulse, problem.contacts[k].normal);
  return problem;
}

template <int D>
void set_scale(StepProblem<D>& problem, const Interaction& interaction, double scale) {
  problem.scale = scale;
  problem.law = contact_law(interaction, problem.h, scale);
}

template <int D>
StepProblem<D> prepare_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                            const TimeStepping& scheme, bool warm_start, bool shallow) {
  std::vector<StepContact> found;
  found.reserve(at(3 * system.grains()));
  const auto considered =
      for_each_step_contact<D>(system, state, interaction, scheme, [&](const StepContact& c) { found.push_back(c); });
  if (shallow) check_overlaps<D>(system, state, interaction, scheme, considered.deep);
  std::vector<std::int32_t> grains(at(system.grains()));
  std::iota(grains.begin(), grains.end(), 0);
  return step_of_contacts<D>(system, state, interaction, scheme, sorted_by_bodies(found, system.grains()),
                             considered.boundary_speed, std::move(grains),
                             warm_start ? state.impulses : std::vector<RememberedImpulse>{});
}

template GrainVelocity<2> free_velocity(const GranularSystem&, const GranularState&, const TimeStepping&,
                                        const std::vector<RigidVelocity>&, Index);
template ConsideredContacts for_each_step_contact<2>(const GranularSystem&, const GranularState&, const Interaction&,
                                                     const TimeStepping&,
                                                     const std::function<void(const StepContact&)>&);
template StepProblem<2> step_of_contacts(const GranularSystem&, const GranularState&, const Interaction&,
                                         const TimeStepping&, std::vector<StepContact>, double,
                                         std::vector<std::int32_t>, const std::vector<RememberedImpulse>&);
template void set_scale(StepProblem<2>&, const Interaction&, double);
template StepProblem<2> prepare_step(const GranularSystem&, const GranularState&, const Interaction&,
                                     const TimeStepping&, bool, bool);
template GrainVelocity<3> free_velocity(const GranularSystem&, const GranularState&, const TimeStepping&,
                                        const std::vector<RigidVelocity>&, Index);
template ConsideredContacts for_each_step_contact<3>(const GranularSystem&, const GranularState&, const Interaction&,
                                                     const TimeStepping&,
                                                     const std::function<void(const StepContact&)>&);
template StepProblem<3> step_of_contacts(const GranularSystem&, const GranularState&, const Interaction&,
                                         const TimeStepping&, std::vector<StepContact>, double,
                                         std::vector<std::int32_t>, const std::vector<RememberedImpulse>&);
template void set_scale(StepProblem<3>&, const Interaction&, double);
template StepProblem<3> prepare_step(const GranularSystem&, const GranularState&, const Interaction&,
                                     const TimeStepping&, bool, bool);
Interpenetration interpenetration(const GranularSystem& system, const std::vector<StepContact>& contacts) {
  Interpenetration result;
  Index overlaps = 0;
  for (const StepContact& c : contacts) {
    if (c.gap >= 0) continue;
    result.maximum = std::max(result.maximum, -c.gap);
    result.relative = std::max(result.relative, -c.gap / smaller_radius(system, c.a, c.b));
    result.mean -= c.gap;
    ++overlaps;
  }
  if (overlaps > 0) result.mean /= static_cast<double>(overlaps);
  return result;
}

}  // namespace nscdd
