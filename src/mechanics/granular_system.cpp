// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/granular_system.hpp"

#include "core/fail.hpp"

namespace nscdd {

namespace {

// Velocity by the entries of a motion.
RigidVelocity interpolated(const Motion& motion, double t) {
  const auto& [centre, time, velocity, oscillations, initial] = motion;
  if (velocity.empty()) return {};
  const auto after = std::upper_bound(time.begin(), time.end(), t);
  if (after == time.begin()) return velocity.front();
  if (after == time.end()) return velocity.back();
  const auto k = static_cast<std::size_t>(after - time.begin());
  const RigidVelocity &a = velocity[k - 1], &b = velocity[k];
  return sum(a, (t - time[k - 1]) / (time[k] - time[k - 1]), sum(b, -1, a));
}

}  // namespace

RigidVelocity sum(const RigidVelocity& a, double factor, const RigidVelocity& b) {
  return {a.x + factor * b.x, a.y + factor * b.y,           a.spin + factor * b.spin,
          a.z + factor * b.z, a.spin_x + factor * b.spin_x, a.spin_y + factor * b.spin_y};
}

RigidVelocity Motion::at(double t) const {
  RigidVelocity result = interpolated(*this, t);
  for (const Oscillation& one : oscillations)
    result = sum(result, std::cos(one.omega * t + one.phase) * std::min(1.0, one.ramp + one.growth * t), one.amplitude);
  return result;
}

Place carried(const Place& p, const Pose& before, const Pose& after) {
  const double dx = p[0] - before.x, dy = p[1] - before.y, dz = p[2] - before.z;
  if (after.angle != before.angle) {
    const double c = std::cos(after.angle - before.angle), s = std::sin(after.angle - before.angle);
    return {after.x + c * dx - s * dy, after.y + s * dx + c * dy, 0};
  }
  const Eigen::Vector3d now = after.turn * (before.turn.conjugate() * Eigen::Vector3d(dx, dy, dz));
  return {after.x + now[0], after.y + now[1], after.z + now[2]};
}

Wall moved(const Wall& wall, const Motion& motion, const Pose& pose) {
  Wall result = wall;
  result.point = carried(wall.point, {.x = motion.centre[0], .y = motion.centre[1], .z = motion.centre[2]}, pose);
  if (pose.angle != 0) {
    const double c = std::cos(pose.angle), s = std::sin(pose.angle);
    result.normal = {c * wall.normal[0] - s * wall.normal[1], s * wall.normal[0] + c * wall.normal[1], 0};
  } else {
    Eigen::Vector3d::Map(result.normal.data()) = pose.turn * Eigen::Vector3d(wall.normal.data());
  }
  return result;
}

namespace {

// A rotation followed by another, given by its axis times its angle, rad. The result is a unit quaternion.
Eigen::Quaterniond turned(const Eigen::Quaterniond& rotation, const Place& angle) {
  const Eigen::Vector3d vector(angle[0], angle[1], angle[2]);
  const double size = vector.norm();
  if (size == 0) return rotation;
  return (Eigen::AngleAxisd(size, vector / size) * rotation).normalized();
}

}  // namespace

Pose advanced(const Pose& pose, const RigidVelocity& velocity, double h, Index dimension) {
  Pose after = pose;
  after.x += h * velocity.x;
  after.y += h * velocity.y;
  after.z += h * velocity.z;
  if (dimension == 2)
    after.angle += h * velocity.spin;
  else
    after.turn = turned(pose.turn, {h * velocity.spin_x, h * velocity.spin_y, h * velocity.spin});
  return after;
}

Place velocity_of_point(const RigidVelocity& velocity, const Pose& pose, const Place& p) {
  const double dx = p[0] - pose.x, dy = p[1] - pose.y, dz = p[2] - pose.z;
  return {velocity.x - (velocity.spin * dy - velocity.spin_y * dz),
          velocity.y + (velocity.spin * dx - velocity.spin_x * dz),
          velocity.z + (velocity.spin_x * dy - velocity.spin_y * dx)};
}

void check(const Boundary& boundary) {
  const Motion& motion = boundary.motion;
  if (motion.time.size() != motion.velocity.size())
    fail("boundary '{}': expected one velocity per time, met {} times and {} velocities", boundary.name,
         motion.time.size(), motion.velocity.size());
  const auto require_finite = [&](const RigidVelocity& v, double time, const char* what, std::size_t k) {
    const double numbers[] = {time, v.x, v.y, v.z, v.spin_x, v.spin_y, v.spin};
    if (!std::ranges::all_of(numbers, [](double one) { return std::isfinite(one); }))
      fail("boundary '{}': expected finite numbers, met one that is not finite in {} {} of its motion", boundary.name,
           what, k);
  };
  require_finite(motion.initial.value_or(RigidVelocity{}), 0, "initial velocity", 0);
  for (std::size_t k = 0; k < motion.oscillations.size(); ++k) {
    const Oscillation& one = motion.oscillations[k];
    for (const double number : {one.omega, one.phase, one.ramp, one.growth})
      require_finite(one.amplitude, number, "oscillation", k);
  }
  for (std::size_t k = 0; k < motion.time.size(); ++k) {
    require_finite(motion.velocity[k], motion.time[k], "entry", k);
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

GranularState initial_state(const GranularSystem& system, std::vector<double> x, std::vector<double> y,
                            std::vector<double> z) {
  GranularState state;
  for (const auto values : numbers_of_grains(system.dimension)) (state.*values).assign(at(system.grains()), 0.0);
  if (system.dimension == 3) state.turn_w.assign(at(system.grains()), 1.0);
  state.x = std::move(x);
  state.y = std::move(y);
  state.z = std::move(z);
  for (const Boundary& boundary : system.boundaries) {
    const auto& centre = boundary.motion.centre;
    state.poses.push_back({.x = centre[0], .y = centre[1], .z = centre[2]});
  }
  return state;
}

std::vector<std::vector<double> GranularState::*> numbers_of_grains(Index dimension) {
  using State = GranularState;
  if (dimension == 2)
    return {&State::x, &State::y, &State::angle, &State::velocity_x, &State::velocity_y, &State::spin};
  return {&State::x,      &State::y,      &State::z,          &State::turn_w,     &State::turn_x,
          &State::turn_y, &State::turn_z, &State::velocity_x, &State::velocity_y, &State::velocity_z,
          &State::spin_x, &State::spin_y, &State::spin};
}

GrainMotion motion_of(const GranularState& state, std::size_t i, double radius) {
  if (state.z.empty()) return {state.velocity_x[i], state.velocity_y[i], 0, 0, 0, radius * state.spin[i]};
  return {state.velocity_x[i],      state.velocity_y[i],      state.velocity_z[i],
          radius * state.spin_x[i], radius * state.spin_y[i], radius * state.spin[i]};
}

void set_motion(GranularState& state, std::size_t i, const GrainMotion& v, double radius) {
  state.velocity_x[i] = v[0];
  state.velocity_y[i] = v[1];
  state.spin[i] = v[5] / radius;
  if (state.z.empty()) return;
  state.velocity_z[i] = v[2];
  state.spin_x[i] = v[3] / radius;
  state.spin_y[i] = v[4] / radius;
}

void move_grain(GranularState& state, std::size_t i, const Place& centre, const Place& angle) {
  state.x[i] = centre[0];
  state.y[i] = centre[1];
  if (state.z.empty()) {
    state.angle[i] += angle[2];
    return;
  }
  state.z[i] = centre[2];
  const Eigen::Quaterniond now = turned({state.turn_w[i], state.turn_x[i], state.turn_y[i], state.turn_z[i]}, angle);
  state.turn_w[i] = now.w();
  state.turn_x[i] = now.x();
  state.turn_y[i] = now.y();
  state.turn_z[i] = now.z();
}

std::string body_name(const GranularSystem& system, Index body) {
  if (body >= system.grains())
    return fmt::format("the wall of boundary '{}'",
                       system.boundaries[at(system.walls[at(body - system.grains())].boundary)].name);
  const std::string_view shape = shape_of_grains(system.dimension);
  if (system.free(body)) return fmt::format("{} {}", shape, body);
  return fmt::format("{} {} of boundary '{}'", shape, body, system.boundaries[at(system.driven_by[at(body)])].name);
}

void check(const GranularSystem& system, const GranularState& state) {
  const auto n = at(system.grains());
  const std::string shapes = fmt::format("{}s", shape_of_grains(system.dimension));
  const auto arrays = numbers_of_grains(system.dimension);
  if (system.mass.size() != n)
    fail("granular state: expected {} {}, met an array of {}", n, shapes, system.mass.size());
  for (const auto values : arrays)
    if ((state.*values).size() != n)
      fail("granular state: expected {} {}, met an array of {}", n, shapes, (state.*values).size());
  if (system.driven_by.size() != n || state.poses.size() != system.boundaries.size())
    fail("granular state: expected {} {} and {} boundaries, met {} and {}", system.driven_by.size(), shapes,
         system.boundaries.size(), n, state.poses.size());
  bool any_free = false;
  for (std::size_t i = 0; i < n; ++i) {
    const auto name = [&] { return fmt::format("{} {}", shape_of_grains(system.dimension), i); };
    if (system.driven_by[i] >= count(system.boundaries))
      fail("{}: expected one of {} boundaries, met number {}", name(), system.boundaries.size(), system.driven_by[i]);
    any_free = any_free || system.driven_by[i] < 0;
    for (const auto values : arrays)
      if (!std::isfinite((state.*values)[i]))
        fail("{}: expected finite positions and velocities, met {}", name(), (state.*values)[i]);
  }
  if (!any_free) throw Error("granular system: expected a free grain, met driven ones only");
  for (const Boundary& boundary : system.boundaries) check(boundary);
}

}  // namespace nscdd
