// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/rigid_body.hpp"

#include "core/fail.hpp"

namespace nscdd {
namespace {

constexpr std::array all_directions{BodyDirection::x,      BodyDirection::y,      BodyDirection::z,
                                    BodyDirection::spin_x, BodyDirection::spin_y, BodyDirection::spin};

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

// Throws Error for times that do not ascend and numbers that are not finite. `what`: "motion" or "load".
void check(const std::string& name, const Motion& motion, const char* what) {
  if (motion.time.size() != motion.velocity.size())
    fail("boundary '{}': expected one velocity per time, met {} times and {} velocities", name, motion.time.size(),
         motion.velocity.size());
  const auto require_finite = [&](const RigidVelocity& v, double time, const char* part, std::size_t k) {
    const double numbers[] = {time, v.x, v.y, v.z, v.spin_x, v.spin_y, v.spin};
    if (!std::ranges::all_of(numbers, [](double one) { return std::isfinite(one); }))
      fail("boundary '{}': expected finite numbers, met one that is not finite in {} {} of its {}", name, part, k,
           what);
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
      fail("boundary '{}': expected ascending times, met {} s after {} s", name, motion.time[k], motion.time[k - 1]);
  }
}

// Whether a motion prescribes anything along a direction.
bool acts(const Motion& motion, BodyDirection direction) {
  const auto is_set = [&](RigidVelocity v) { return along(v, direction) != 0; };
  return std::ranges::any_of(motion.velocity, is_set) ||
         std::ranges::any_of(motion.oscillations, is_set, &Oscillation::amplitude);
}

void check(const std::string& name, const Motion& motion, const FreeBody& body, Index dimension) {
  const auto refuse = [&](const std::string& expected, const std::string& met) {
    fail("boundary '{}': expected {}, met {}", name, expected, met);
  };
  check(name, body.load, "load");
  Index free = 0, spins = 0;
  for (const BodyDirection direction : all_directions) {
    const std::string word(to_string(direction));
    const bool in_plane =
        direction == BodyDirection::x || direction == BodyDirection::y || direction == BodyDirection::spin;
    if (body.free(direction)) {
      if (dimension == 2 && !in_plane) refuse("free directions x, y and spin in the plane", word);
      if (acts(motion, direction)) refuse("directions that are free or driven", word + " as both");
      ++free;
      spins += direction >= BodyDirection::spin_x;
    } else if (acts(body.load, direction)) {
      refuse("forces along free directions", "one along " + word + ", which is driven");
    }
  }
  if (free == 0) refuse("a free direction with a mass", "none");
  if (!(body.mass > 0) || !std::isfinite(body.mass) || !std::isfinite(1 / body.mass))
    refuse("a finite mass > 0", fmt::format("{} kg", body.mass));
  if (dimension == 3 && spins != 0 && spins != 3)
    refuse("all rotations free in space, or none", fmt::format("{} of 3", spins));
  for (std::size_t k = 0; k < 3; ++k)
    if (const double one = body.inertia[k]; spins > 0 && (dimension == 3 || k == 2) && !(one > 0 && std::isfinite(one)))
      refuse("finite moments of inertia > 0 of a body that turns freely", fmt::format("{} kg m^2", one));
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
  const double c = std::cos(pose.angle), s = std::sin(pose.angle);
  for (const auto direction : {&Wall::normal, &Wall::axis}) {
    const std::array<double, 3>& before = wall.*direction;
    if (pose.angle != 0)
      result.*direction = {c * before[0] - s * before[1], s * before[0] + c * before[1], before[2]};
    else
      Eigen::Vector3d::Map((result.*direction).data()) = pose.turn * Eigen::Vector3d(before.data());
  }
  return result;
}

Eigen::Quaterniond turned(const Eigen::Quaterniond& rotation, const Place& angle) {
  const Eigen::Vector3d vector(angle[0], angle[1], angle[2]);
  const double size = vector.norm();
  if (size == 0) return rotation;
  return (Eigen::AngleAxisd(size, vector / size) * rotation).normalized();
}

Place rotation_between(const Pose& before, const Pose& after) {
  const Eigen::AngleAxisd turn(after.turn * before.turn.conjugate());
  const Eigen::Vector3d vector = turn.angle() * turn.axis();
  return {vector[0], vector[1], vector[2] + after.angle - before.angle};
}

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

double& along(RigidVelocity& velocity, BodyDirection direction) {
  const std::array<double*, 6> numbers{&velocity.x,      &velocity.y,      &velocity.z,
                                       &velocity.spin_x, &velocity.spin_y, &velocity.spin};
  return *numbers[static_cast<std::size_t>(direction)];
}

void take_free(const FreeBody& body, RigidVelocity from, RigidVelocity& to) {
  for (const BodyDirection direction : all_directions)
    if (body.free(direction)) along(to, direction) = along(from, direction);
}

std::array<double, 3> FreeBody::rims(Index dimension) const {
  const double ratio = dimension == 2 ? rim_mass_ratio<2> : rim_mass_ratio<3>;
  std::array<double, 3> lengths{1, 1, 1};
  for (std::size_t k = 0; k < 3; ++k)
    if (inertia[k] > 0) lengths[k] = std::sqrt(ratio * inertia[k] / mass);
  return lengths;
}

Eigen::Matrix3d principal_axes(const FreeBody& body, const Pose& pose) {
  return (pose.turn * body.axes).toRotationMatrix();
}

GrainMotion motion_of(const FreeBody& body, const Pose& pose, const RigidVelocity& v, Index dimension) {
  const std::array<double, 3> rims = body.rims(dimension);
  if (dimension == 2) return {v.x, v.y, 0, 0, 0, rims[2] * v.spin};
  const Eigen::Vector3d spin = principal_axes(body, pose).transpose() * Eigen::Vector3d(v.spin_x, v.spin_y, v.spin);
  return {v.x, v.y, v.z, rims[0] * spin[0], rims[1] * spin[1], rims[2] * spin[2]};
}

RigidVelocity rigid_velocity(const FreeBody& body, const Pose& pose, const GrainMotion& v, Index dimension) {
  const std::array<double, 3> rims = body.rims(dimension);
  if (dimension == 2) return {v[0], v[1], v[5] / rims[2]};
  const Eigen::Vector3d spin =
      principal_axes(body, pose) * Eigen::Vector3d(v[3] / rims[0], v[4] / rims[1], v[5] / rims[2]);
  return {v[0], v[1], spin[2], v[2], spin[0], spin[1]};
}

bool turns(const Motion& motion) {
  return acts(motion, BodyDirection::spin_x) || acts(motion, BodyDirection::spin_y) ||
         acts(motion, BodyDirection::spin);
}

void check(const Boundary& boundary, Index dimension) {
  check(boundary.name, boundary.motion, "motion");
  if (!boundary.body) return;
  check(boundary.name, boundary.motion, *boundary.body, dimension);
  if (boundary.orientation == Orientation::fixed)
    fail("boundary '{}': expected grains that turn with a body that moves freely, met orientation fixed",
         boundary.name);
}

}  // namespace nscdd
