// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/time_stepping.hpp"
#include "packing/grain_grid.hpp"

namespace nscdd {
namespace {

// A grain that moves by more than so many of its radii in one step passes through others unseen.
constexpr double largest_move = 10;

// Where everything is when contacts are found.
struct Configuration {
  std::vector<double> x, y;            // of every disk at q_m, m
  std::vector<Wall> walls;             // at q_m
  std::vector<Pose> poses;             // of boundaries at q_m
  std::vector<RigidVelocity> motions;  // of boundaries in this step
};

// Velocities of all disks. The state knows those of free disks; a boundary gives those of the disks it drives.
std::vector<DiskVelocity> start_velocities(const GranularSystem& system, const GranularState& state,
                                           const std::vector<RigidVelocity>& motions) {
  std::vector<DiskVelocity> result(at(system.disks()));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double radius = system.radius[i];
    if (system.driven_by[i] < 0) {
      result[i] = {state.velocity_x[i], state.velocity_y[i], radius * state.spin[i], 1 / system.mass[i]};
    } else {
      const auto k = at(system.driven_by[i]);
      const auto v = velocity_of_point(motions[k], state.poses[k], {state.x[i], state.y[i]});
      const bool turns = system.boundaries[k].orientation == Orientation::turning;
      result[i] = {v[0], v[1], turns ? radius * motions[k].spin : 0.0, 0};
    }
  }
  return result;
}

void check_moves(const GranularSystem& system, const GranularState& state, const std::vector<DiskVelocity>& v,
                 double h) {
  for (std::size_t i = 0; i < at(system.disks()); ++i) {
    const auto name = [&] { return body_name(system, static_cast<Index>(i)); };
    if (!std::isfinite(state.x[i]) || !std::isfinite(state.y[i]))
      fail("{}: expected a finite position, met ({}, {}) m", name(), state.x[i], state.y[i]);
    const double move = h * std::hypot(v[i].x, v[i].y);
    if (!(move <= largest_move * system.radius[i]) || !std::isfinite(v[i].rim))
      fail(
          "{}: expected to move by at most {} of its radii in a step, met a velocity of ({}, {}) m/s and a step of {} "
          "s",
          name(), largest_move, v[i].x, v[i].y, h);
  }
}

Configuration middle(const GranularSystem& system, const GranularState& state,
                     const std::vector<RigidVelocity>& motions, double time) {
  Configuration where{state.x, state.y, system.walls, state.poses, motions};
  for (std::size_t k = 0; k < where.poses.size(); ++k) where.poses[k] = advanced(where.poses[k], motions[k], time);
  for (std::size_t i = 0; i < where.x.size(); ++i) {
    if (system.driven_by[i] < 0) {
      where.x[i] += time * state.velocity_x[i];
      where.y[i] += time * state.velocity_y[i];
    } else {
      const auto k = at(system.driven_by[i]);
      const auto centre = carried({where.x[i], where.y[i]}, state.poses[k], where.poses[k]);
      where.x[i] = centre[0];
      where.y[i] = centre[1];
    }
  }
  for (Wall& wall : where.walls)
    wall = moved(wall, system.boundaries[at(wall.boundary)].motion, where.poses[at(wall.boundary)]);
  return where;
}

// Pairs of a free disk and a disk or wall, ascending by (a, b), whose gap is within the alert distance, or would be
// after the step at the velocities V^- + h g and those of the boundaries. `least_alert`, m, replaces an alert distance
// of the scheme that is smaller. Throws Error naming both disks if two have the same centre.
std::vector<StepContact> find_contacts(const GranularSystem& system, const Configuration& where,
                                       const std::vector<DiskVelocity>& free, const TimeStepping& scheme,
                                       double least_alert) {
  double fastest = 0;
  for (Index i = 0; i < system.disks(); ++i) fastest = std::max(fastest, std::hypot(free[at(i)].x, free[at(i)].y));
  const double smallest = *std::min_element(system.radius.begin(), system.radius.end());
  const double alert = std::max(scheme.alert * smallest, least_alert);
  const double range = std::max(alert, 2 * fastest * scheme.step);  // the fastest pair may close so much
  std::vector<StepContact> found;
  found.reserve(at(3 * system.disks()));
  const auto add_if_near = [&](const StepContact& c, double x, double y) {  // x, y: velocity of b
    const double closing = c.normal[0] * (x - free[at(c.a)].x) + c.normal[1] * (y - free[at(c.a)].y);
    const bool far = c.gap > alert && c.gap + scheme.step * closing > alert;
    if (!far) found.push_back(c);
  };
  const GrainGrid grid({where.x, where.y, {}}, system.radius, 1, range);
  grid.for_each_pair([&](Index a, Index b) {
    const double dx = where.x[at(b)] - where.x[at(a)], dy = where.y[at(b)] - where.y[at(a)];
    const double touch = system.radius[at(a)] + system.radius[at(b)];
    const double near = touch + range;
    const double square = dx * dx + dy * dy;
    if (square > near * near || (!system.free(a) && !system.free(b))) return;
    const double distance = std::sqrt(square);
    if (!(distance > 0))
      fail("{} and {}: expected distinct centres, met one", body_name(system, a), body_name(system, b));
    add_if_near({.a = a,
                 .b = b,
                 .normal = {dx / distance, dy / distance},
                 .point = {(where.x[at(a)] + where.x[at(b)]) / 2, (where.y[at(a)] + where.y[at(b)]) / 2},
                 .gap = distance - touch},
                free[at(b)].x, free[at(b)].y);
  });
  for (Index w = 0; w < count(where.walls); ++w) {
    const auto& [point, normal, boundary] = where.walls[at(w)];
    for (Index i = 0; i < system.disks(); ++i) {
      if (!system.free(i)) continue;
      const double x = where.x[at(i)], y = where.y[at(i)];
      const double height = (x - point[0]) * normal[0] + (y - point[1]) * normal[1];
      const std::array<double, 2> foot{x - height * normal[0], y - height * normal[1]};
      const auto v = velocity_of_point(where.motions[at(boundary)], where.poses[at(boundary)], foot);
      add_if_near({.a = i,
                   .b = system.disks() + w,
                   .normal = {-normal[0], -normal[1]},
                   .point = foot,
                   .gap = height - system.radius[at(i)]},
                  v[0], v[1]);
    }
  }
  return sorted_by_bodies(found, system.disks());
}

// Adds one body per wall contact, which moves as the wall does under the grain. Returns the second body of each
// contact.
std::vector<Index> add_wall_bodies(StepProblem& problem, const GranularSystem& system, const Configuration& where) {
  std::vector<Index> second;
  for (const StepContact& c : problem.geometry) {
    second.push_back(c.b);
    if (c.b < system.disks()) continue;
    const Index boundary = where.walls[at(c.b - system.disks())].boundary;
    const auto v = velocity_of_point(where.motions[at(boundary)], where.poses[at(boundary)], c.point);
    second.back() = count(problem.free);
    problem.free.push_back({v[0], v[1], 0, 0});
    problem.start.push_back(problem.free.back());
  }
  return second;
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
  const DiskVelocity &a = problem.free[at(c.a)], &b = problem.free[at(second)];
  const bool driven = a.inverse_mass == 0 || b.inverse_mass == 0;
  DiskContact k{.a = static_cast<std::int32_t>(c.a),
                .b = static_cast<std::int32_t>(second),
                .normal = c.normal,
                .inverse_w = disk_delassus(a, b),
                .bias = {c.gap > 0 ? c.gap / problem.h : std::max(correction * c.gap / problem.h, -push), 0},
                .friction = driven ? problem.boundary_friction : problem.friction};
  if (interaction.restitution > 0 || interaction.tangential_restitution > 0) {
    const LocalVector<2> before = relative_velocity(k, problem.start);
    if (interaction.restitution > 0) k.bias.n = interaction.restitution * std::min(0.0, before.n);
    k.bias.t = interaction.tangential_restitution * before.t;
  }
  return k;
}

}  // namespace

double push_speed(const TimeStepping& scheme, double smaller_radius, double boundary_speed) {
  if (scheme.maximum_push_speed >= 0) return scheme.maximum_push_speed;
  const double gravity = std::hypot(scheme.gravity[0], scheme.gravity[1]);
  return natural_push_speed * (std::sqrt(gravity * smaller_radius) + boundary_speed);
}

void check_overlaps(const GranularSystem& system, const StepProblem& problem, double largest) {
  for (const StepContact& c : problem.geometry)
    if (c.gap < -largest * smaller_radius(system, c))
      fail("{} and {}: expected an overlap of at most {} of the smaller radius, met {} m", body_name(system, c.a),
           body_name(system, c.b), largest, -c.gap);
}

StepProblem prepare_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                         const TimeStepping& scheme, bool warm_start) {
  const double h = scheme.step;
  const auto motions = boundary_velocities(system, state.time + h / 2);
  StepProblem problem;
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
  const std::vector<Index> second = add_wall_bodies(problem, system, where);
  const double boundary_speed = fastest_boundary(problem.start);
  problem.contacts.reserve(problem.geometry.size());
  for (std::size_t k = 0; k < problem.geometry.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    problem.contacts.push_back(solver_contact(c, second[k], problem, interaction, scheme.penetration_correction,
                                              push_speed(scheme, smaller_radius(system, c), boundary_speed)));
    if (problem.pulls && touches(system, c)) problem.contacts.back().pull = pull;
    problem.scale += 1 / problem.contacts.back().inverse_w.inverse_n;
  }
  problem.scale /= std::max(1.0, static_cast<double>(problem.contacts.size()));
  problem.law = contact_law(interaction, h, problem.scale);
  if (!warm_start) return problem;
  const auto last = remembered(state.impulses, problem.geometry);
  for (std::size_t k = 0; k < last.size(); ++k)
    if (last[k] != nullptr) problem.contacts[k].impulse = last[k]->impulse;
  return problem;
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
