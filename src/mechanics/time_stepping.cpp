// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/time_stepping.hpp"

#include "mechanics/step_contacts.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

// A grain that moves by more than so many of its radii in one step passes through others unseen.
constexpr double largest_move = 10;

std::vector<RigidVelocity> boundary_velocities(const GranularSystem& system, double time) {
  std::vector<RigidVelocity> result;
  for (const Boundary& boundary : system.boundaries) result.push_back(boundary.motion.at(time));
  return result;
}

// Velocities of all disks. The state knows those of free disks; a boundary gives those of the disks it
// drives.
std::vector<DiskVelocity> start_velocities(const GranularSystem& system, const GranularState& state,
                                           const std::vector<RigidVelocity>& motions) {
  std::vector<DiskVelocity> result(at(system.disks()));
  for (Index i = 0; i < system.disks(); ++i) {
    const double radius = system.radius[at(i)];
    if (system.free(i)) {
      result[at(i)] = {state.velocity_x[at(i)], state.velocity_y[at(i)], radius * state.spin[at(i)],
                       1 / system.mass[at(i)]};
    } else {
      const Index k = system.driven_by[at(i)];
      const RigidVelocity& motion = motions[at(k)];
      const auto v = velocity_of_point(motion, state.poses[at(k)], {state.x[at(i)], state.y[at(i)]});
      const bool turns = system.boundaries[at(k)].orientation == Orientation::turning;
      result[at(i)] = {v[0], v[1], turns ? radius * motion.spin : 0.0, 0};
    }
  }
  return result;
}

void check_moves(const GranularSystem& system, const GranularState& state, const std::vector<DiskVelocity>& v,
                 double h) {
  for (Index i = 0; i < system.disks(); ++i) {
    if (!std::isfinite(state.x[at(i)]) || !std::isfinite(state.y[at(i)]))
      throw Error(fmt::format("{}: expected a finite position, met ({}, {}) m", body_name(system, i), state.x[at(i)],
                              state.y[at(i)]));
    const double move = h * std::hypot(v[at(i)].x, v[at(i)].y);
    if (!(move <= largest_move * system.radius[at(i)]) || !std::isfinite(v[at(i)].rim))
      throw Error(
          fmt::format("{}: expected to move by at most {} of its radii in a step, met a velocity of "
                      "({}, {}) m/s and a step of {} s",
                      body_name(system, i), largest_move, v[at(i)].x, v[at(i)].y, h));
  }
}

// A driven disk goes round the reference point of its boundary on the exact circle, not along its tangent.
void move_driven(double& x, double& y, const Pose& before, const Pose& after) {
  const double c = std::cos(after.angle - before.angle), s = std::sin(after.angle - before.angle);
  const double dx = x - before.x, dy = y - before.y;
  x = after.x + c * dx - s * dy;
  y = after.y + s * dx + c * dy;
}

Configuration middle(const GranularSystem& system, const GranularState& state,
                     const std::vector<RigidVelocity>& motions, double time) {
  Configuration where{state.x, state.y, system.walls, state.poses, motions};
  for (std::size_t k = 0; k < where.poses.size(); ++k) where.poses[k] = advanced(where.poses[k], motions[k], time);
  for (Index i = 0; i < system.disks(); ++i) {
    if (system.free(i)) {
      where.x[at(i)] += time * state.velocity_x[at(i)];
      where.y[at(i)] += time * state.velocity_y[at(i)];
    } else {
      const auto k = at(system.driven_by[at(i)]);
      move_driven(where.x[at(i)], where.y[at(i)], state.poses[k], where.poses[k]);
    }
  }
  for (Wall& wall : where.walls)
    wall = moved(wall, system.boundaries[at(wall.boundary)].motion, where.poses[at(wall.boundary)]);
  return where;
}

// Adds one body per wall contact, which moves as the wall does at the foot of the grain.
void add_wall_bodies(StepProblem& problem, const GranularSystem& system, const Configuration& where,
                     const std::vector<RigidVelocity>& motions, std::vector<Index>& second) {
  for (std::size_t k = 0; k < problem.geometry.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    second[k] = c.b;
    if (c.b < system.disks()) continue;
    const Index boundary = where.walls[at(c.b - system.disks())].boundary;
    const auto v = velocity_of_point(motions[at(boundary)], where.poses[at(boundary)], c.point);
    second[k] = count(problem.free);
    problem.free.push_back({v[0], v[1], 0, 0});
    problem.start.push_back(problem.free.back());
  }
}

// Of the bodies whose motion is prescribed, m/s.
double fastest_boundary(const std::vector<DiskVelocity>& velocities) {
  double fastest = 0;
  for (const DiskVelocity& v : velocities)
    if (v.inverse_mass == 0) fastest = std::max(fastest, std::hypot(v.x, v.y));
  return fastest;
}

double smaller_radius(const GranularSystem& system, const StepContact& c) {
  const double a = system.radius[at(c.a)];
  return c.b < system.disks() ? std::min(a, system.radius[at(c.b)]) : a;
}

bool touches(const GranularSystem& system, const StepContact& c) {
  return c.gap <= touching_gap * smaller_radius(system, c);
}

DiskContact solver_contact(const StepContact& c, Index second, const StepProblem& problem,
                           const Interaction& interaction, double correction, double push) {
  DiskContact k;
  k.a = static_cast<std::int32_t>(c.a);
  k.b = static_cast<std::int32_t>(second);
  k.normal_x = c.normal[0];
  k.normal_y = c.normal[1];
  const DiskVelocity &a = problem.free[at(c.a)], &b = problem.free[at(second)];
  k.inverse_w = disk_delassus(a, b);
  const bool driven = a.inverse_mass == 0 || b.inverse_mass == 0;
  k.friction = driven ? problem.boundary_friction : problem.friction;
  k.bias_n = c.gap > 0 ? c.gap / problem.h : std::max(correction * c.gap / problem.h, -push);
  if (interaction.restitution > 0 || interaction.tangential_restitution > 0) {
    const LocalVector before = relative_velocity(k, problem.start);
    if (interaction.restitution > 0) k.bias_n = interaction.restitution * std::min(0.0, before.n);
    k.bias_t = interaction.tangential_restitution * before.t;
  }
  return k;
}

// Both lists ascend by (a, b).
void start_from(std::vector<DiskContact>& contacts, const std::vector<StepContact>& geometry,
                const std::vector<RememberedImpulse>& remembered) {
  auto old = remembered.begin();
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const auto key = std::pair(geometry[k].a, geometry[k].b);
    while (old != remembered.end() && std::pair(old->a, old->b) < key) ++old;
    if (old == remembered.end()) return;
    if (std::pair(old->a, old->b) != key) continue;
    contacts[k].impulse_n = old->impulse.n;
    contacts[k].impulse_t = old->impulse.t;
  }
}

}  // namespace

double mean_normal_delassus(const StepProblem& problem) {
  double sum = 0;
  for (const DiskContact& c : problem.contacts) sum += 1 / c.inverse_w.inverse_n;
  return problem.contacts.empty() ? 0 : sum / static_cast<double>(problem.contacts.size());
}

double push_speed(const TimeStepping& scheme, double smaller_radius, double boundary_speed) {
  if (scheme.maximum_push_speed >= 0) return scheme.maximum_push_speed;
  const double gravity = std::hypot(scheme.gravity[0], scheme.gravity[1]);
  return natural_push_speed * (std::sqrt(gravity * smaller_radius) + boundary_speed);
}

void check_overlaps(const GranularSystem& system, const StepProblem& problem, double largest) {
  for (const StepContact& c : problem.geometry) {
    if (c.gap < -largest * smaller_radius(system, c))
      throw Error(fmt::format("{} and {}: expected an overlap of at most {} of the smaller radius, met {} m",
                              body_name(system, c.a), body_name(system, c.b), largest, -c.gap));
  }
}

StepProblem prepare_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                         const TimeStepping& scheme, bool warm_start) {
  const double h = scheme.step;
  const auto motions = boundary_velocities(system, state.time + h / 2);
  StepProblem problem;
  problem.h = h;
  const ContactLaw law = contact_law(interaction, h);
  const bool has_friction = rubs(law);
  problem.friction = has_friction ? interaction.friction : 0;
  problem.boundary_friction = has_friction ? interaction.friction_at_boundaries() : 0;
  problem.pulls = pulls(law);
  problem.tangential_bias = interaction.tangential_restitution > 0;
  problem.start = start_velocities(system, state, motions);
  problem.free = problem.start;
  for (Index i = 0; i < system.disks(); ++i) {
    if (!system.free(i)) continue;
    problem.free[at(i)].x += h * scheme.gravity[0];
    problem.free[at(i)].y += h * scheme.gravity[1];
  }
  check_moves(system, state, problem.free, h);
  const Configuration where = middle(system, state, motions, (1 - scheme.theta) * h);
  // Bodies that hold each other are found however short the alert distance.
  const double hold = problem.pulls ? touching_gap * *std::max_element(system.radius.begin(), system.radius.end()) : 0;
  problem.geometry = find_contacts(system, where, problem.free, scheme, hold);
  // With restitution a contact acts once it touches: the predicted gap would swallow the impact.
  if (interaction.restitution > 0)
    std::erase_if(problem.geometry,
                  [&](const StepContact& c) { return c.gap > 0 && !(problem.pulls && touches(system, c)); });
  std::vector<Index> second(problem.geometry.size());
  add_wall_bodies(problem, system, where, motions, second);
  const double boundary_speed = fastest_boundary(problem.start);
  problem.contacts.reserve(problem.geometry.size());
  for (std::size_t k = 0; k < problem.geometry.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    problem.contacts.push_back(solver_contact(c, second[k], problem, interaction, scheme.penetration_correction,
                                              push_speed(scheme, smaller_radius(system, c), boundary_speed)));
    if (problem.pulls && touches(system, c)) problem.contacts.back().pull = pull(law);
  }
  if (warm_start) start_from(problem.contacts, problem.geometry, state.impulses);
  return problem;
}

std::vector<DiskVelocity> velocities_of(const StepProblem& problem, std::span<const DiskContact> contacts) {
  std::vector<DiskVelocity> v = problem.free;
  for (const DiskContact& c : contacts) apply_impulse(c, {c.impulse_n, c.impulse_t}, v);
  return v;
}

StepEnergy energy_of(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme) {
  StepEnergy energy;
  for (Index i = 0; i < system.disks(); ++i) {
    if (!system.free(i)) continue;
    const double m = system.mass[at(i)], rim = system.radius[at(i)] * state.spin[at(i)];
    energy.kinetic += m / 2 *
                      (state.velocity_x[at(i)] * state.velocity_x[at(i)] +
                       state.velocity_y[at(i)] * state.velocity_y[at(i)] + rim * rim / rim_mass_ratio);
    energy.potential -= m * (scheme.gravity[0] * state.x[at(i)] + scheme.gravity[1] * state.y[at(i)]);
  }
  return energy;
}

StepEnergy finish_step(const GranularSystem& system, GranularState& state, const StepProblem& problem,
                       const TimeStepping& scheme, std::span<const DiskContact> contacts,
                       std::span<const DiskVelocity> velocities) {
  const double h = problem.h, theta = scheme.theta;
  const StepEnergy before = energy_of(system, state, scheme);
  const auto motions = boundary_velocities(system, state.time + h / 2);
  const std::vector<Pose> poses = state.poses;
  for (std::size_t k = 0; k < poses.size(); ++k) state.poses[k] = advanced(poses[k], motions[k], h);
  for (std::size_t i = 0; i < at(system.disks()); ++i) {
    const DiskVelocity& v = velocities[i];
    const double spin = v.rim / system.radius[i];
    if (system.driven_by[i] < 0) {
      state.x[i] += h * ((1 - theta) * state.velocity_x[i] + theta * v.x);
      state.y[i] += h * ((1 - theta) * state.velocity_y[i] + theta * v.y);
      state.angle[i] += h * ((1 - theta) * state.spin[i] + theta * spin);
    } else {
      const auto k = at(system.driven_by[i]);
      move_driven(state.x[i], state.y[i], poses[k], state.poses[k]);
      state.angle[i] += h * spin;
    }
    state.velocity_x[i] = v.x;
    state.velocity_y[i] = v.y;
    state.spin[i] = spin;
  }
  state.impulses.clear();
  double boundary_work = 0, dissipation = 0;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const DiskContact& c = contacts[k];
    if (c.impulse_n == 0 && c.impulse_t == 0) continue;
    const StepContact& g = problem.geometry[k];
    state.impulses.push_back({g.a, g.b, {c.impulse_n, c.impulse_t}});
    const LocalVector v0 = relative_velocity(c, problem.start), v1 = relative_velocity(c, velocities);
    dissipation -= (c.impulse_n * (v0.n + v1.n) + c.impulse_t * (v0.t + v1.t)) / 2;
    // Work of the impulses -r on a, r on b at the velocities of those that are driven.
    for (const auto& [body, sign] : {std::pair(c.a, -1.0), std::pair(c.b, 1.0)}) {
      const DiskVelocity& v = velocities[static_cast<std::size_t>(body)];
      if (v.inverse_mass > 0) continue;
      const auto impulse = impulse_on_disk(c.normal(), sign, {c.impulse_n, c.impulse_t});
      boundary_work -= impulse[0] * v.x + impulse[1] * v.y + impulse[2] * v.rim;
    }
  }
  ++state.step;
  state.time = static_cast<double>(state.step) * h;
  StepEnergy energy = energy_of(system, state, scheme);
  energy.boundary_work = boundary_work;
  energy.dissipation = dissipation;
  energy.numerical =
      energy.kinetic + energy.potential - before.kinetic - before.potential - boundary_work + dissipation;
  return energy;
}

Interpenetration interpenetration(const GranularSystem& system, const StepProblem& problem) {
  Interpenetration result;
  Index overlaps = 0;
  for (const StepContact& c : problem.geometry) {
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
