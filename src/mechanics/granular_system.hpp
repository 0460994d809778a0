// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/grain_contacts.hpp"

#include <Eigen/Geometry>

namespace nscdd {

using Place = Direction<3>;  ///< a place, m, or another vector; in the plane its third number is 0

inline double dot(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
/// a + factor b
inline Place moved_along(Place a, double factor, const Place& b) {
  for (std::size_t k = 0; k < 3; ++k) a[k] += factor * b[k];
  return a;
}
inline Place difference(const Place& to, const Place& from) { return moved_along(to, -1, from); }

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

/// How grains of a boundary follow its turn.
enum class Orientation {
  turning,  ///< they turn with it, as parts of one rigid body
  fixed,    ///< their centres go round, without spin
};
constexpr auto names_of(Orientation) { return std::to_array<std::string_view>({"turning", "fixed"}); }

/// A rigid body driven by a motion: grains (GranularSystem::driven_by) or a wall.
struct Boundary {
  std::string name;
  Motion motion;
  Orientation orientation = Orientation::turning;  ///< of its grains
};

/// Place of the reference point of a boundary, and its turn: in the plane an angle, in space a rotation.
struct Pose {
  double x = 0, y = 0, angle = 0;  ///< m, rad
  double z = 0;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

/// A wall at time 0, which moves with its boundary: in the plane a straight line, in space a plane, with grains on the
/// side that `normal` points to. With a radius it is a circular cylinder in space, unbounded along its axis.
struct Wall {
  std::array<double, 3> point{0, 0, 0};   ///< m; of a cylinder on its axis
  std::array<double, 3> normal{0, 1, 0};  ///< unit; of a cylinder along its axis
  Index boundary = 0;
  double radius = 0;  ///< of a cylinder, m: > 0 with grains inside, < 0 with grains outside; 0 of a plane
};

/// The place of a point of a body that goes from one pose to another: on the exact circle, not on its tangent.
Place carried(const Place& p, const Pose& before, const Pose& after);

/// The wall when its boundary has moved from the centre of its motion to `pose`.
Wall moved(const Wall& wall, const Motion& motion, const Pose& pose);

Pose advanced(const Pose& pose, const RigidVelocity& velocity, double h, Index dimension);

Place velocity_of_point(const RigidVelocity& velocity, const Pose& pose, const Place& p);

/// Throws Error naming the boundary if times do not ascend, counts differ or a number is not finite.
void check(const Boundary& boundary);

/// Disks in the plane or spheres in space, walls, and boundaries that drive them. Grains of a packing come first.
struct GranularSystem {
  Index dimension = 2;           ///< 2 in the plane, 3 in space
  std::vector<double> radius;    ///< m
  std::vector<double> mass;      ///< kg; that of a driven grain has no effect
  std::vector<Index> driven_by;  ///< boundary that moves a grain, -1 for a free one
  std::vector<Wall> walls;
  std::vector<Boundary> boundaries;

  Index grains() const { return count(radius); }
  Index free_grains() const { return std::count(driven_by.begin(), driven_by.end(), Index{-1}); }
  bool free(Index grain) const { return driven_by[at(grain)] < 0; }
  /// 1/kg; 0 for a driven grain.
  double inverse_mass(Index grain) const { return free(grain) ? 1 / mass[at(grain)] : 0; }
  /// The smaller radius of grain a and body b, m: that of the grain where b is a wall.
  double smaller_radius(Index a, Index b) const {
    return b < grains() ? std::min(radius[at(a)], radius[at(b)]) : radius[at(a)];
  }
  double length(const Place& a) const { return dimension == 2 ? std::hypot(a[0], a[1]) : std::hypot(a[0], a[1], a[2]); }
};

/// Impulse of a contact in the last step. Bodies a < b: grains by their number, wall w as grains() + w.
struct RememberedImpulse {
  Index a = 0, b = 0;
  /// N s: in the plane (n, t, 0) in the frame of the contact, in space (x, y, z) on b, since tangents may jump.
  std::array<double, 3> impulse{};
};

/// The impulse of a contact with that normal as it is remembered, and back, at a normal that may have turned since.
template <int D>
std::array<double, 3> to_remember(const LocalVector<D>& impulse, const Direction<D>& normal) {
  if constexpr (D == 2)
    return {impulse.n, impulse.t, 0};
  else
    return along_axes(normal, impulse);
}
template <int D>
LocalVector<D> recalled(const std::array<double, 3>& impulse, const Direction<D>& normal) {
  if constexpr (D == 2)
    return {impulse[0], impulse[1]};
  else
    return in_frame(normal, impulse);
}

/// Interface impulse on the copy of a grain in a subdomain, (A_E^T F_Gamma) of that copy.
struct RememberedGluing {
  Index grain = 0, subdomain = 0;
  std::array<double, 6> impulse{};  ///< on the unknowns of a grain, N s: (x, y, rim), in space (x, y, z, three rims)
};

/// Subdomain of a contact at the last decomposition.
struct RememberedSubdomain {
  Index a = 0, b = 0, subdomain = 0;
};

/// Model of a subdomain in the last step of a run that switches models.
struct RememberedModel {
  Index switched = 0;             ///< 1 if it ended the step with the simpler model, 0 if with the law itself
  Index standing = 0;             ///< iterations, over steps, for which none of its statuses has changed
  Index switched_iterations = 0;  ///< of the step, in which it had the simpler model
  Index switch_backs = 0;         ///< of the step
  /// Largest distance of the simpler model from the law, at a switch back and at the end, see ModelSwitch.
  double velocity_distance = 0;  ///< m/s
  double impulse_distance = 0;   ///< relative to the interface impulses
};

/// Everything that changes in a run; a restart from it repeats every bit. If ranks share steps, each remembers the
/// contacts of its own subdomains (share_step); the rest is replicated.
struct GranularState {
  Index step = 0;                              ///< steps done
  double time = 0;                             ///< s
  std::vector<double> x, y, angle;             ///< of every disk, m and rad
  std::vector<double> velocity_x, velocity_y;  ///< m/s
  std::vector<double> spin;                    ///< rad/s, about z
  std::vector<double> z, velocity_z;           ///< only in space, m and m/s
  std::vector<double> spin_x, spin_y;          ///< only in space, rad/s
  /// In space, in place of `angle`: the rotation of every sphere since time 0, unit quaternions w + x i + y j + z k.
  std::vector<double> turn_w, turn_x, turn_y, turn_z;
  std::vector<Pose> poses;                      ///< of every boundary
  std::vector<RememberedImpulse> impulses;      ///< of the last step, ascending by (a, b)
  std::vector<RememberedGluing> gluing;         ///< of the last step, ascending by (grain, subdomain)
  std::vector<RememberedSubdomain> subdomains;  ///< of the contacts of the last step, ascending by (a, b)
  std::vector<RememberedModel> models;          ///< of the subdomains, in their order; empty unless they are switched
  std::vector<Index> process_of_subdomain;      ///< its owner, if ranks share steps; empty at the beginning of a run
  Index decomposed_at = -1;                     ///< last step whose contacts were partitioned afresh
  double eta = 0;                               ///< best flexibility at that step, 1/kg; 0 if none was asked for
};

constexpr std::string_view shape_of_grains(Index dimension) { return dimension == 2 ? "disk" : "sphere"; }

std::vector<RigidVelocity> boundary_velocities(const GranularSystem& system, double time);

/// The state at time 0: grains at rest at their places, boundaries at their centres. z is empty in the plane.
GranularState initial_state(const GranularSystem& system, std::vector<double> x, std::vector<double> y,
                            std::vector<double> z = {});

/// The arrays of the state with a number per grain in a system of that dimension.
std::vector<std::vector<double> GranularState::*> numbers_of_grains(Index dimension);

inline Place centre_of(const GranularState& state, std::size_t grain) {
  return {state.x[grain], state.y[grain], state.z.empty() ? 0 : state.z[grain]};
}

/// Gets and sets the velocity of a grain; the speed of the rim is `radius` x spin.
GrainMotion motion_of(const GranularState& state, std::size_t grain, double radius);
void set_motion(GranularState& state, std::size_t grain, const GrainMotion& velocity, double radius);

/// Moves the centre of a grain there, m, and turns the grain by an axis times an angle, rad.
void move_grain(GranularState& state, std::size_t grain, const Place& centre, const Place& angle);

/// "disk 3", "sphere 3", "disk 130 of boundary 'left'", or "the wall of boundary 'right'" (grains() + its number).
std::string body_name(const GranularSystem& system, Index body);

/// Throws Error naming the grain or boundary for wrong sizes, numbers not finite, a missing boundary, no free grain.
void check(const GranularSystem& system, const GranularState& state);

}  // namespace nscdd
