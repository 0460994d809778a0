// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/grain_contacts.hpp"

#include <Eigen/Geometry>

namespace nscdd {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Place = Direction<3>;  ///< a place, m, or another vector; in the plane its third number is 0

inline double dot(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
/// a + factor b
inline Place moved_along(Place a, double factor, const Place& b) {
  for (std::size_t k = 0; k < 3; ++k) a[k] += factor * b[k];
  return a;
}
inline Place cross(const Place& a, const Place& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Place difference(const Place& to, const Place& from) { return moved_along(to, -1, from); }
inline Place divided(Place a, double divisor) {
  for (double& number : a) number /= divisor;
  return a;
}

/// Velocity of a grain, (x, y, z, rim_x, rim_y, rim_z), in the plane (x, y, 0, 0, 0, rim), m/s.
using GrainMotion = GrainUnknowns<3>;
inline Place velocity_of(const GrainMotion& v) { return {v[0], v[1], v[2]}; }
inline GrainMotion motion_of(const GrainVelocity<2>& v) { return {v.x, v.y, 0, 0, 0, v.rim}; }
inline GrainMotion motion_of(const GrainVelocity<3>& v) { return unknowns(v); }
template <int D>
GrainVelocity<D> with_motion(const GrainMotion& v, double inverse_mass) {
  if constexpr (D == 2)
    return {v[0], v[1], v[5], inverse_mass};
  else
    return with_unknowns(v, inverse_mass);
}

/// Velocity of the reference point of a rigid body, m/s, and its spin, rad/s; the last three are 0 in the plane.
struct RigidVelocity {
  double x = 0, y = 0, spin = 0;
  double z = 0, spin_x = 0, spin_y = 0;
};
/// a + factor b
RigidVelocity sum(const RigidVelocity& a, double factor, const RigidVelocity& b);

/// An oscillation of a rigid body: amplitude cos(omega t + phase) min(1, ramp + growth t).
struct Oscillation {
  RigidVelocity amplitude;
  double omega = 0, phase = 0;  ///< rad/s and rad
  double ramp = 1, growth = 0;  ///< part of the amplitude at time 0, and its growth, 1/s
};

/// Prescribed motion of a rigid body: velocities at given times, linear in between, constant before the first and after
/// the last, none without entries; plus oscillations. The body turns about its reference point.
struct Motion {
  std::array<double, 3> centre{0, 0, 0};  ///< reference point at time 0, m; in the plane z = 0
  std::vector<double> time;               ///< s, ascending
  std::vector<RigidVelocity> velocity;
  std::vector<Oscillation> oscillations = {};
  std::optional<RigidVelocity> initial = {};  ///< before time 0, see first_motions; by default that at time 0

  RigidVelocity at(double t) const;
};

/// Whether a motion ever turns its body.
bool turns(const Motion& motion);

/// How grains of a boundary follow its turn.
enum class Orientation {
  turning,  ///< they turn with it, as parts of one rigid body
  fixed,    ///< their centres go round, without spin
};
constexpr auto names_of(Orientation) { return std::to_array<std::string_view>({"turning", "fixed"}); }

/// A direction of a rigid body: a translation or a rotation. In the plane x, y and spin.
enum class BodyDirection { x, y, z, spin_x, spin_y, spin };
constexpr auto names_of(BodyDirection) {
  return std::to_array<std::string_view>({"x", "y", "z", "spin_x", "spin_y", "spin"});
}
double& along(RigidVelocity& velocity, BodyDirection direction);

/// What moves a rigid body along its free directions. In space all of its rotations are free, or none.
struct FreeBody {
  std::array<bool, 6> directions{};  ///< by BodyDirection; the others are prescribed by a Motion
  double mass = 0;                   ///< kg
  std::array<double, 3> inertia{};   ///< principal moments about the centre of mass, kg m^2; in the plane the third
  Eigen::Quaterniond axes = Eigen::Quaterniond::Identity();  ///< principal axes at time 0
  /// Applied force, N, and moment, N m, without gravity, as a function of time; its `centre` is unused.
  Motion load = {};
  bool torque_turns = false;  ///< in space: moments are along the principal axes; else along x, y and z
  double reach = 0;           ///< from its centre to the farthest point of its grains, m; 0: it has none

  bool free(BodyDirection direction) const { return directions[static_cast<std::size_t>(direction)]; }
  bool wholly_free(Index dimension) const { return std::ranges::count(directions, true) == (dimension == 2 ? 3 : 6); }
  /// Rim radii, m, for each principal axis. A grain of this radius and mass has the same inertia; 1 without inertia.
  std::array<double, 3> rims(Index dimension) const;
};
/// Sets `to` along the free directions of a body to `from`.
void take_free(const FreeBody& body, RigidVelocity from, RigidVelocity& to);

/// Where a boundary releases its grains one by one, see release_grains.
struct GrainSource {
  Place point{0, 0, 0};  ///< m
  double distance = 0;   ///< m, from the point to the centres of moving grains before the next one comes
};

/// A rigid body of grains (GranularSystem::driven_by) or a wall: driven by a motion but along the free directions, if
/// it has any. Its reference point, Motion::centre, is then its centre of mass.
struct Boundary {
  std::string name;
  Motion motion;
  Orientation orientation = Orientation::turning;  ///< of its grains
  std::optional<FreeBody> body = {};
  Index node = -1;  ///< number among the bodies of a step, see number_bodies; -1: nothing is free
  std::optional<GrainSource> source = {};  ///< its grains wait at rest, and touch nothing
};

/// Place of the reference point of a boundary, and its turn: in the plane an angle, in space a rotation.
struct Pose {
  double x = 0, y = 0, angle = 0;  ///< m, rad
  double z = 0;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();

  Place place() const { return {x, y, z}; }
};

/// A wall at time 0, which moves with its boundary: in the plane a straight line, in space a plane, with grains on the
/// side that `normal` points to. With a radius it is a circular cylinder, in the plane a circle. With a length and a
/// radius > 0 it is a plank with round edges, grains all around: all points within `radius` of a segment, in space of a
/// rectangle. With a length and a radius < 0 it is a cylinder with flat ends.
struct Wall {
  std::array<double, 3> point{0, 0, 0};   ///< m; of a cylinder on its axis; of a plank, or between ends, the middle
  std::array<double, 3> normal{0, 1, 0};  ///< unit; of a cylinder along its axis, of a circle (0, 0, 1)
  Index boundary = 0;
  /// Of a cylinder, m: > 0 with grains inside, < 0 with grains outside; half the thickness of a plank; 0 of a plane.
  double radius = 0;
  std::array<double, 3> axis{};  ///< unit, along the length of a plank, across its normal
  /// Of the segment or rectangle of a plank, m; of a cylinder with grains outside half its length, 0 if it has no ends.
  double half_length = 0, half_width = 0;

  bool plank() const { return half_length > 0 && radius > 0; }
  bool round() const { return radius != 0 && !plank(); }  ///< a cylinder or a circle
  bool has_ends() const { return half_length > 0 && radius < 0; }
};

/// The place of a point of a body that goes from one pose to another: on the exact circle, not on its tangent.
Place carried(const Place& p, const Pose& before, const Pose& after);

/// The wall when its boundary has moved from the centre of its motion to `pose`.
Wall moved(const Wall& wall, const Motion& motion, const Pose& pose);

/// A rotation followed by another, given by its axis times its angle, rad; a unit quaternion.
Eigen::Quaterniond turned(const Eigen::Quaterniond& rotation, const Place& angle);
/// The axis times the angle, rad, by which a boundary turns from one pose to another.
Place rotation_between(const Pose& before, const Pose& after);

Pose advanced(const Pose& pose, const RigidVelocity& velocity, double h, Index dimension);

Place velocity_of_point(const RigidVelocity& velocity, const Pose& pose, const Place& p);

/// Throws Error naming the boundary if times do not ascend, counts differ, a number is not finite, or a free body has
/// no mass, no inertia about a free axis, a direction that is free and driven, or a force along a driven one.
void check(const Boundary& boundary, Index dimension);

/// Velocity of a body with free directions in a step: the speeds of its rims are about its principal axes at that pose.
GrainMotion motion_of(const FreeBody& body, const Pose& pose, const RigidVelocity& velocity, Index dimension);
RigidVelocity rigid_velocity(const FreeBody& body, const Pose& pose, const GrainMotion& motion, Index dimension);
/// Its principal axes at that pose, as columns.
Eigen::Matrix3d principal_axes(const FreeBody& body, const Pose& pose);

}  // namespace nscdd
