// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/step_contacts.hpp"

#include <fmt/ranges.h>

namespace nscdd {
namespace {

// A grain that moves by more than so many of its radii in one step passes through others unseen.
constexpr double largest_move = 10;

template <int D>
GrainVelocity<D> driven_velocity(const Direction<D>& v) {
  GrainUnknowns<D> u{};
  std::copy(v.begin(), v.end(), u.begin());
  return with_unknowns(u, 0);
}

// Velocities of all grains. The state knows those of free ones; a boundary gives those of the grains it drives.
template <int D>
std::vector<GrainVelocity<D>> start_velocities(const GranularSystem& system, const GranularState& state,
                                               const std::vector<RigidVelocity>& motions) {
  std::vector<GrainVelocity<D>> result(at(system.disks()));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double radius = system.radius[i];
    if (system.driven_by[i] < 0) {
      result[i] = with_unknowns(unknowns_of<D>(state, i, radius), 1 / system.mass[i]);
      continue;
    }
    const auto k = at(system.driven_by[i]);
    result[i] = driven_velocity<D>(velocity_of_point(motions[k], state.poses[k], centre_of<D>(state, i)));
    if (system.boundaries[k].orientation != Orientation::turning) continue;
    if constexpr (D == 2) {
      result[i].rim = radius * motions[k].spin;
    } else {
      result[i].rim_x = radius * motions[k].spin_x;
      result[i].rim_y = radius * motions[k].spin_y;
      result[i].rim_z = radius * motions[k].spin;
    }
  }
  return result;
}

template <int D>
void check_moves(const GranularSystem& system, const GranularState& state, const std::vector<GrainVelocity<D>>& v,
                 double h) {
  const auto finite = [](double number) { return std::isfinite(number); };
  for (std::size_t i = 0; i < at(system.disks()); ++i) {
    const auto name = [&] { return body_name(system, static_cast<Index>(i)); };
    const Direction<D> centre = centre_of<D>(state, i), velocity = velocity_of<D>(v[i]);
    if (!std::ranges::all_of(centre, finite))
      fail("{}: expected a finite position, met ({}) m", name(), fmt::join(centre, ", "));
    const double move = h * speed_of<D>(v[i]);
    if (!(move <= largest_move * system.radius[i]) || !std::isfinite(squared_rim(v[i])))
      fail("{}: expected to move by at most {} of its radii in a step, met a velocity of ({}) m/s and a step of {} s",
           name(), largest_move, fmt::join(velocity, ", "), h);
  }
}

// Adds one body per wall contact, which moves as the wall does under the grain. Returns the second body of each
// contact.
template <int D>
std::vector<Index> add_wall_bodies(StepProblem<D>& problem, const GranularSystem& system,
                                   const Configuration<D>& where) {
  std::vector<Index> second;
  for (const StepContact& c : problem.geometry) {
    second.push_back(c.b);
    if (c.b < system.disks()) continue;
    const Index boundary = where.walls[at(c.b - system.disks())].boundary;
    second.back() = count(problem.free);
    problem.free.push_back(driven_velocity<D>(
        velocity_of_point(where.motions[at(boundary)], where.poses[at(boundary)], narrowed<D>(c.point))));
    problem.start.push_back(problem.free.back());
  }
  return second;
}

// Of the bodies whose motion is prescribed, m/s.
template <int D>
double fastest_boundary(const std::vector<GrainVelocity<D>>& velocities) {
  double fastest = 0;
  for (const GrainVelocity<D>& v : velocities)
    if (v.inverse_mass == 0) fastest = std::max(fastest, speed_of<D>(v));
  return fastest;
}

double smaller_radius(const GranularSystem& system, const StepContact& c) {
  const double a = system.radius[at(c.a)];
  return c.b < system.disks() ? std::min(a, system.radius[at(c.b)]) : a;
}

bool touches(const GranularSystem& system, const StepContact& c) {
  return c.gap <= touching_gap * smaller_radius(system, c);
}

template <int D>
GrainContact<D> solver_contact(const StepContact& c, Index second, const StepProblem<D>& problem,
                               const Interaction& interaction, double correction, double push) {
  const GrainVelocity<D>&a = problem.free[at(c.a)], &b = problem.free[at(second)];
  const bool driven = a.inverse_mass == 0 || b.inverse_mass == 0;
  GrainContact<D> k{.a = static_cast<std::int32_t>(c.a),
                    .b = static_cast<std::int32_t>(second),
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

void check_overlaps(const GranularSystem& system, const std::vector<StepContact>& contacts, double largest) {
  for (const StepContact& c : contacts)
    if (c.gap < -largest * smaller_radius(system, c))
      fail("{} and {}: expected an overlap of at most {} of the smaller radius, met {} m", body_name(system, c.a),
           body_name(system, c.b), largest, -c.gap);
}

template <int D>
StepProblem<D> prepare_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                            const TimeStepping& scheme, bool warm_start) {
  const double h = scheme.step;
  const auto motions = boundary_velocities(system, state.time + h / 2);
  StepProblem<D> problem;
  problem.h = h;
  double pull = 0;
  const auto take_from = [&](const auto& law) {
    problem.friction = law.rubs ? interaction.friction : 0;
    problem.boundary_friction = law.rubs ? interaction.friction_at_boundaries() : 0;
    problem.pulls = law.pulls;
    pull = law.pull();
  };
  std::visit(take_from, contact_law(interaction, h, 1));  // the scale, yet unknown, matters to none of these
  problem.tangential_bias = interaction.tangential_restitution > 0;
  problem.start = start_velocities<D>(system, state, motions);
  problem.free = problem.start;
  const Direction<D> gravity = gravity_of<D>(scheme);
  for (Index i = 0; i < system.disks(); ++i) {
    if (!system.free(i)) continue;
    GrainVelocity<D>& v = problem.free[at(i)];
    v.x += h * gravity[0];
    v.y += h * gravity[1];
    if constexpr (D == 3) v.z += h * gravity[2];
  }
  check_moves<D>(system, state, problem.free, h);
  const Configuration<D> where = middle<D>(system, state, motions, (1 - scheme.theta) * h);
  // Bodies that hold each other are found however short the alert distance.
  const double hold = problem.pulls ? touching_gap * *std::max_element(system.radius.begin(), system.radius.end()) : 0;
  problem.geometry = find_contacts<D>(system, where, problem.free, scheme, hold);
  // With restitution a contact acts once it touches: the predicted gap would swallow the impact.
  if (interaction.restitution > 0)
    std::erase_if(problem.geometry,
                  [&](const StepContact& c) { return c.gap > 0 && !(problem.pulls && touches(system, c)); });
  const std::vector<Index> second = add_wall_bodies<D>(problem, system, where);
  const double boundary_speed = fastest_boundary<D>(problem.start);
  problem.contacts.reserve(problem.geometry.size());
  for (std::size_t k = 0; k < problem.geometry.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    problem.contacts.push_back(solver_contact<D>(c, second[k], problem, interaction, scheme.penetration_correction,
                                                 push_speed(scheme, smaller_radius(system, c), boundary_speed)));
    if (problem.pulls && touches(system, c)) problem.contacts.back().pull = pull;
    problem.scale += 1 / problem.contacts.back().inverse_w.inverse_n;
  }
  problem.scale /= std::max(1.0, static_cast<double>(problem.contacts.size()));
  problem.law = contact_law(interaction, h, problem.scale);
  if (!warm_start) return problem;
  const auto last = remembered(state.impulses, problem.geometry);
  for (std::size_t k = 0; k < last.size(); ++k)
    if (last[k] != nullptr) problem.contacts[k].impulse = recalled<D>(last[k]->impulse, problem.contacts[k].normal);
  return problem;
}

template StepProblem<2> prepare_step(const GranularSystem&, const GranularState&, const Interaction&,
                                     const TimeStepping&, bool);
template StepProblem<3> prepare_step(const GranularSystem&, const GranularState&, const Interaction&,
                                     const TimeStepping&, bool);

Interpenetration interpenetration(const GranularSystem& system, const std::vector<StepContact>& contacts) {
  Interpenetration result;
  Index overlaps = 0;
  for (const StepContact& c : contacts) {
    if (c.gap >= 0) continue;
    result.maximum = std::max(result.maximum, -c.gap);
    result.relative = std::max(result.relative, -c.gap / smaller_radius(system, c));
    result.mean -= c.gap;
    ++overlaps;
  }
  if (overlaps > 0) result.mean /= static_cast<double>(overlaps);
  return result;
}

}  // namespace nscdd
