// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/path.hpp"

namespace nscdd {

Place nearest_in_plank(const Wall& plank, const Place& p) {
  const Place from_middle = difference(p, plank.point), across = cross(plank.normal, plank.axis);
  const double s = std::clamp(dot(from_middle, plank.axis), -plank.half_length, plank.half_length);
  const double t = std::clamp(dot(from_middle, across), -plank.half_width, plank.half_width);
  return moved_along(moved_along(plank.point, s, plank.axis), t, across);
}

WallPoint nearest_point(const Wall& wall, const Place& centre) {
  const Place &point = wall.point, &normal = wall.normal;
  const double along = dot(difference(centre, point), normal);
  if (wall.radius == 0) return {moved_along(centre, -along, normal), normal, along};
  // `outwards`: away from the middle of a plank, or from the axis of a cylinder, whose direction is `normal`.
  const bool plank = wall.plank();
  const Place middle = plank ? nearest_in_plank(wall, centre) : moved_along(point, along, normal);
  const Place away = difference(centre, middle);
  const double distance = std::sqrt(dot(away, away));
  Place outwards = plank ? normal : tangents_of(normal).first;  // if all points are as near
  if (distance > 0) outwards = divided(away, distance);
  if (plank) return {moved_along(middle, wall.radius, outwards), outwards, distance - wall.radius};
  const double radius = std::abs(wall.radius), inwards = wall.radius > 0 ? -1 : 1;
  const double beyond = std::abs(along) - wall.half_length, aside = std::max(distance - radius, 0.0);
  if (wall.has_ends() && beyond > std::min(distance - radius, 0.0)) {  // an end or its edge is the nearest
    const double sign = along > 0 ? 1 : -1, height = aside > 0 ? std::hypot(beyond, aside) : beyond;
    const Place foot = moved_along(moved_along(point, sign * wall.half_length, normal), distance - aside, outwards);
    if (aside == 0) return {foot, moved_along({}, sign, normal), height};
    return {foot, moved_along(moved_along({}, sign * beyond / height, normal), aside / height, outwards), height};
  }
  const Place foot = moved_along(middle, radius, outwards);
  for (double& one : outwards) one *= inwards;
  return {foot, outwards, inwards * (distance - radius)};
}

Place image_step(const GranularSystem& system, const Wall& wall, const Place& centre) {
  if (wall.radius == 0 || !system.period.any()) return {};
  return difference(difference(centre, wall.point), system.apart(wall.point, centre));
}

WallPoint nearest_point(const GranularSystem& system, const Wall& wall, const Place& centre) {
  if (!system.period.any()) return nearest_point(wall, centre);
  const Place step = image_step(system, wall, centre);
  WallPoint found = nearest_point(wall, difference(centre, step));
  found.foot = moved_along(found.foot, 1, step);
  return found;
}

namespace {

// The configuration `time` after the state, at its velocities and `motions` of boundaries.
Configuration configuration(const StepStart& start, const std::vector<RigidVelocity>& motions, double time) {
  const auto& [system, state, interaction, scheme] = start;
  Configuration where{state.x, state.y, state.z, system.walls, state.poses, step_motions(start)};
  for (std::size_t k = 0; k < where.poses.size(); ++k)
    where.poses[k] = advanced(where.poses[k], motions[k], time, system.dimension);
  for (std::size_t i = 0; i < where.x.size(); ++i) {
    Place centre = where.centre(i);
    if (const Index k = system.driven_by[i]; k >= 0)
      centre = carried(centre, state.poses[at(k)], where.poses[at(k)]);
    else
      centre = moved_along(centre, time, velocity_of(motion_of(state, i, 1)));
    where.x[i] = centre[0];
    where.y[i] = centre[1];
    if (!where.z.empty()) where.z[i] = centre[2];
  }
  for (Wall& wall : where.walls)
    wall = moved(wall, system.boundaries[at(wall.boundary)].motion, where.poses[at(wall.boundary)]);
  return where;
}

// Largest error of the chords of a path, times the smallest radius.
constexpr double chord_error = 0.01;
constexpr double most_chords = 32;  // even if a boundary turns by far too much

// Largest distance of what a boundary may touch from its reference point: its own grains, or with a wall the box of
// all.
double farthest(const StepStart& start, std::size_t boundary) {
  const GranularState& state = start.state;
  const Pose& pose = state.poses[boundary];
  const auto& body = start.system.boundaries[boundary].body;
  const auto of_it = [&](const Wall& wall) { return at(wall.boundary) == boundary; };
  if (body && body->reach > 0 && std::ranges::none_of(start.system.walls, of_it)) return body->reach;
  const auto along = [](const std::vector<double>& x, double from) {
    const auto [low, high] = std::ranges::minmax(x);
    return std::max(std::abs(high - from), std::abs(low - from));
  };
  return std::hypot(along(state.x, pose.x), along(state.y, pose.y), state.z.empty() ? 0 : along(state.z, pose.z));
}

double spin_of(const RigidVelocity& v) { return std::hypot(v.spin_x, v.spin_y, v.spin); }

// Bound of the speed of a grain relative to another or to a wall, m/s. velocity(i): of a free grain.
double fastest_of(const StepStart& start, const std::vector<RigidVelocity>& motions, const auto& velocity) {
  const auto& [system, state, interaction, scheme] = start;
  Place low, high;
  low.fill(system.boundaries.empty() ? infinity : 0);
  high.fill(system.boundaries.empty() ? -infinity : 0);
  for (std::size_t i = 0; i < at(system.grains()); ++i) {
    if (system.driven_by[i] >= 0) continue;
    const GrainMotion v = velocity(i);
    for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], v[k]), high[k] = std::max(high[k], v[k]);
  }
  double boundaries = 0, second = 0;  // the two largest speeds: two free bodies may meet head-on
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const double arm = spin_of(motions[k]) > 0 ? farthest(start, k) : 0;
    const double speed = std::hypot(motions[k].x, motions[k].y, motions[k].z) + spin_of(motions[k]) * arm;
    second = std::max(second, std::min(speed, boundaries));
    boundaries = std::max(boundaries, speed);
  }
  if (!system.free_bodies.empty()) boundaries += second;
  return system.length(difference(high, low)) + boundaries;
}

// Number of chords for the arcs of a time.
double chords(const StepStart& start, const std::vector<RigidVelocity>& motions, double time) {
  double most = 1;
  const double smallest = std::ranges::min(start.system.radius);
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const double angle = time * spin_of(motions[k]);
    if (angle == 0) continue;
    const double sagitta = farthest(start, k) * angle * angle / 8;
    most = std::max(most, std::ceil(std::sqrt(sagitta / (chord_error * smallest))));
  }
  return std::min(most, most_chords);
}

// Part of a path with constant velocities of the boundaries.
struct Leg {
  double from = 0, to = 0;  // s, relative to the state
  std::vector<RigidVelocity> motions;
};

Path path_of(const StepStart& start, const std::vector<Leg>& legs, bool always) {
  const auto& [system, state, interaction, scheme] = start;
  Path path{.system = system, .begins_run = state.step == 0};
  const auto velocity = [&state = state](std::size_t i) { return motion_of(state, i, 1); };
  const auto add = [&](const Leg& leg, double time) {
    path.times.push_back(time);
    path.places.push_back(configuration(start, leg.motions, time));
  };
  for (const Leg& leg : legs) path.reach += (leg.to - leg.from) * fastest_of(start, leg.motions, velocity);
  // Centres of grains with the largest overlap accepted are 1.5 times the smaller radius apart.
  const bool followed = path.reach > 1.5 * largest_turn * std::ranges::min(system.radius);
  if (followed || always) {
    add(legs.front(), legs.front().from);
    for (const Leg& leg : legs) {
      const double number = chords(start, leg.motions, leg.to - leg.from);
      for (double k = 1; k < number; ++k) add(leg, leg.from + k / number * (leg.to - leg.from));
      if (&leg == &legs.back()) break;
      if (!system.boundaries.empty()) path.bend = path.places.size();
      add(leg, leg.to);
    }
  }
  add(legs.back(), legs.back().to);
  return path;
}

// From where contacts were found to the state.
Leg leg_before(const StepStart& start) {
  const auto& [system, state, interaction, scheme] = start;
  const bool at_end = scheme.boundary_instant == BoundaryInstant::end;
  return {-scheme.theta * scheme.step, 0,
          boundary_velocities(system, state, at_end ? state.time : state.time - scheme.step / 2)};
}

std::vector<Leg> legs_to_contacts(const StepStart& start) {
  const auto& [system, state, interaction, scheme] = start;
  std::vector<Leg> legs;
  if (state.step > 0) legs.push_back(leg_before(start));
  legs.push_back({0, (1 - scheme.theta) * scheme.step, first_motions(start)});
  return legs;
}

}  // namespace

Configuration where_contacts_are(const StepStart& start) {
  return configuration(start, first_motions(start), (1 - start.scheme.theta) * start.scheme.step);
}

Path Path::to_contacts(const StepStart& start) { return path_of(start, legs_to_contacts(start), false); }

Path Path::whole(const StepStart& start, bool onwards) {
  std::vector<Leg> legs = legs_to_contacts(start);
  if (onwards) legs.push_back({legs.back().to, legs.back().to + start.scheme.step, step_motions(start)});
  return path_of(start, legs, true);
}

Path Path::to_end(const StepStart& after) { return path_of(after, {leg_before(after)}, false); }

bool end_is_near(const StepStart& start, const std::vector<GrainMotion>& velocities) {
  const auto& [system, state, interaction, scheme] = start;
  const double fastest = fastest_of(start, step_motions(start), [&](std::size_t i) { return velocities[i]; });
  return scheme.theta * scheme.step * fastest <= largest_overlap * std::ranges::min(system.radius);
}

}  // namespace nscdd
