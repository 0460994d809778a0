// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/boundary.hpp"

#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

Wall moved(const Wall& wall, const Motion& motion, const Pose& pose) {
  const double c = std::cos(pose.angle), s = std::sin(pose.angle);
  const double dx = wall.point[0] - motion.centre[0], dy = wall.point[1] - motion.centre[1];
  Wall result = wall;
  result.point = {pose.x + c * dx - s * dy, pose.y + s * dx + c * dy};
  result.normal = {c * wall.normal[0] - s * wall.normal[1], s * wall.normal[0] + c * wall.normal[1]};
  return result;
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
    throw Error(fmt::format("boundary '{}': expected one velocity per time, met {} times and {} velocities",
                            boundary.name, motion.time.size(), motion.velocity.size()));
  for (std::size_t k = 0; k < motion.time.size(); ++k) {
    const RigidVelocity& v = motion.velocity[k];
    if (!std::isfinite(motion.time[k]) || !std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.spin))
      throw Error(fmt::format("boundary '{}': expected finite numbers, met another in entry {} of its motion",
                              boundary.name, k));
    if (k > 0 && !(motion.time[k] > motion.time[k - 1]))
      throw Error(fmt::format("boundary '{}': expected ascending times, met {} s after {} s", boundary.name,
                              motion.time[k], motion.time[k - 1]));
  }
}

}  // namespace nscdd
