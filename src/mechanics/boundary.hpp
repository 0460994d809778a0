// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>
#include <nscdd/core/types.hpp>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace nscdd {

/// Velocity of a rigid body in the plane: of its reference point, m/s, and its spin, rad/s.
struct RigidVelocity {
  double x = 0, y = 0, spin = 0;
};

/// Prescribed motion of a rigid body: velocities at given times, linear in between, constant before the first
/// and after the last. One entry is a uniform motion, no entry is rest. To turn a body about a foot, put the
/// reference point there.
struct Motion {
  std::array<double, 2> centre{0, 0};  ///< reference point at time 0, m
  std::vector<double> time;            ///< s, ascending
  std::vector<RigidVelocity> velocity;

  RigidVelocity at(double t) const;
};

/// What the disks of a boundary do while it turns.
enum class Orientation {
  turning,  ///< they turn with it, as parts of one rigid body
  fixed,    ///< their centres go round, but they keep their angle and do not spin
};
constexpr auto names_of(Orientation) { return std::to_array<std::string_view>({"turning", "fixed"}); }

/// A boundary: a rigid body driven by a motion. It consists of disks (GranularSystem::driven_by), or is a
/// straight wall.
struct Boundary {
  std::string name;
  Motion motion;
  Orientation orientation = Orientation::turning;  ///< of its disks
};

/// Where a boundary is: its reference point and the angle it has turned by.
struct Pose {
  double x = 0, y = 0, angle = 0;  ///< m, rad
};

/// A straight wall: grains stay in the half-plane that `normal` points to. It is given at time 0 and moves
/// with its boundary.
struct Wall {
  std::array<double, 2> point{0, 0};
  std::array<double, 2> normal{0, 1};  ///< unit
  Index boundary = 0;
};

/// The wall when its boundary has moved from the centre of its motion to `pose`.
Wall moved(const Wall& wall, const Motion& motion, const Pose& pose);

/// The pose after a time h at constant velocity.
Pose advanced(const Pose& pose, const RigidVelocity& velocity, double h);

/// Velocity of the point p of a body with that pose, m/s.
std::array<double, 2> velocity_of_point(const RigidVelocity& velocity, const Pose& pose,
                                        const std::array<double, 2>& p);

/// Throws Error naming the boundary if times do not ascend, counts differ or a number is not finite.
void check(const Boundary& boundary);

}  // namespace nscdd
