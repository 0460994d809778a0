// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/granular_system.hpp"

#include "core/fail.hpp"

#include <fmt/format.h>

namespace nscdd {

RigidVelocity Motion::at(double t) const {
  if (velocity.empty()) return {};
  const auto after = std::upper_bound(time.begin(), time.end(), t);
  if (after == time.begin()) return velocity.front();
  if (after == time.end()) return velocity.back();
  const auto k = static_cast<std::size_t>(after - time.begin());
  const double s = (t - time[k - 1]) / (time[k] - time[k - 1]);
  const auto between = [s](double a, double b) { return a + s * (b - a); };
  const RigidVelocity &a = velocity[k - 1], &b = velocity[k];
  return {between(a.x, b.x), between(a.y, b.y), between(a.spin, b.spin)};
}

std::array<double, 2> carried(const std::array<double, 2>& p, const Pose& before, const Pose& after) {
  const double c = std::cos(after.angle - before.angle), s = std::sin(after.angle - before.angle);
  const double dx = p[0] - before.x, dy = p[1] - before.y;
  return {after.x + c * dx - s * dy, after.y + s * dx + c * dy};
}

Wall moved(const Wall& wall, const Motion& motion, const Pose& pose) {
  const double c = std::cos(pose.angle), s = std::sin(pose.angle);
  return {.point = carried(wall.point, {motion.centre[0], motion.centre[1]}, pose),
          .normal = {c * wall.normal[0] - s * wall.normal[1], s * wall.normal[0] + c * wall.normal[1]},
          .boundary = wall.boundary};
}

Pose advanced(const Pose& pose, const RigidVelocity& velocity, double h) {
  return {pose.x + h * velocity.x, pose.y + h * velocity.y, pose.angle + h * velocity.spin};
}

std::array<double, 2> velocity_of_point(const RigidVelocity& velocity, const Pose& pose,
                                        const std::array<double, 2>& p) {
  return {velocity.x - velocity.spin * (p[1] - pose.y), velocity.y + velocity.spin * (p[0] - pose.x)};
}

void check(const Boundary& boundary) {
  const Motion& motion = boundary.motion;
  if (motion.time.size() != motion.velocity.size())
    fail("boundary '{}': expected one velocity per time, met {} times and {} velocities", boundary.name,
         motion.time.size(), motion.velocity.size());
  for (std::size_t k = 0; k < motion.time.size(); ++k) {
    const RigidVelocity& v = motion.velocity[k];
    if (!std::isfinite(motion.time[k]) || !std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.spin))
      fail("boundary '{}': expected finite numbers, met another in entry {} of its motion", boundary.name, k);
    if (k > 0 && !(motion.time[k] > motion.time[k - 1]))
      fail("boundary '{}': expected ascending times, met {} s after {} s", boundary.name, motion.time[k],
           motion.time[k - 1]);
  }
}

std::vector<RigidVelocity> boundary_velocities(const GranularSystem& system, double time) {
  std::vector<RigidVelocity> result;
  for (const Boundary& boundary : system.boundaries) result.push_back(boundary.motion.at(time));
  return result;
}

GranularState initial_state(const GranularSystem& system, std::vector<double> x, std::vector<double> y) {
  GranularState state;
  const std::vector<double> zero(at(system.disks()), 0.0);
  state.x = std::move(x);
  state.y = std::move(y);
  state.angle = state.velocity_x = state.velocity_y = state.spin = zero;
  for (const Boundary& boundary : system.boundaries)
    state.poses.push_back({boundary.motion.centre[0], boundary.motion.centre[1], 0});
  return state;
}

std::string body_name(const GranularSystem& system, Index body) {
  if (body >= system.disks())
    return fmt::format("the wall of boundary '{}'",
                       system.boundaries[at(system.walls[at(body - system.disks())].boundary)].name);
  if (system.free(body)) return fmt::format("disk {}", body);
  return fmt::format("disk {} of boundary '{}'", body, system.boundaries[at(system.driven_by[at(body)])].name);
}

void check(const GranularSystem& system, const GranularState& state) {
  const auto n = at(system.disks());
  for (const auto* field :
       {&system.mass, &state.x, &state.y, &state.angle, &state.velocity_x, &state.velocity_y, &state.spin})
    if (field->size() != n) fail("granular state: expected {} disks, met an array of {}", n, field->size());
  if (system.driven_by.size() != n || state.poses.size() != system.boundaries.size())
    fail("granular state: expected {} disks and {} boundaries, met {} and {}", system.driven_by.size(),
         system.boundaries.size(), n, state.poses.size());
  bool any_free = false;
  for (std::size_t i = 0; i < n; ++i) {
    if (system.driven_by[i] >= count(system.boundaries))
      fail("disk {}: expected one of {} boundaries, met number {}", i, system.boundaries.size(), system.driven_by[i]);
    any_free = any_free || system.driven_by[i] < 0;
    for (const auto* field : {&state.x, &state.y, &state.angle, &state.velocity_x, &state.velocity_y, &state.spin})
      if (!std::isfinite((*field)[i]))
        fail("disk {}: expected finite positions and velocities, met {}", i, (*field)[i]);
  }
  if (!any_free) throw Error("granular system: expected a free grain, met driven ones only");
  for (const Boundary& boundary : system.boundaries) check(boundary);
}

}  // namespace nscdd
