// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/contact_law.hpp"
#include <nscdd/core/choice.hpp>

namespace nscdd {

/// Velocity of a rigid body in the plane: of its reference point, m/s, and its spin, rad/s.
struct RigidVelocity {
  double x = 0, y = 0, spin = 0;
};

/// Prescribed motion of a rigid body: velocities at given times, linear in between, constant before the first and after
/// the last. No entry is rest. To turn a body about a foot, put the reference point there.
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

/// A rigid body driven by a motion: disks (GranularSystem::driven_by) or a straight wall.
struct Boundary {
  std::string name;
  Motion motion;
  Orientation orientation = Orientation::turning;  ///< of its disks
};

/// Where a boundary is: its reference point and the angle it has turned by.
struct Pose {
  double x = 0, y = 0, angle = 0;  ///< m, rad
};

/// A straight wall at time 0: grains stay in the half-plane that `normal` points to. It moves with its boundary.
struct Wall {
  std::array<double, 2> point{0, 0};
  std::array<double, 2> normal{0, 1};  ///< unit
  Index boundary = 0;
};

/// Where a point of a body is after the body went from one pose to another: on the exact circle, not on its tangent.
std::array<double, 2> carried(const std::array<double, 2>& p, const Pose& before, const Pose& after);

/// The wall when its boundary has moved from the centre of its motion to `pose`.
Wall moved(const Wall& wall, const Motion& motion, const Pose& pose);

/// The pose after a time h at constant velocity.
Pose advanced(const Pose& pose, const RigidVelocity& velocity, double h);

/// Velocity of the point p of a body with that pose, m/s.
std::array<double, 2> velocity_of_point(const RigidVelocity& velocity, const Pose& pose,
                                        const std::array<double, 2>& p);

/// Throws Error naming the boundary if times do not ascend, counts differ or a number is not finite.
void check(const Boundary& boundary);

/// Disks and walls, and what drives them. The grains of a packing come first, then the disks of boundaries.
struct GranularSystem {
  std::vector<double> radius;    ///< m
  std::vector<double> mass;      ///< kg; that of a driven disk has no effect
  std::vector<Index> driven_by;  ///< boundary that moves a disk, -1 for a free one
  std::vector<Wall> walls;
  std::vector<Boundary> boundaries;

  Index disks() const { return count(radius); }
  Index free_disks() const { return std::count(driven_by.begin(), driven_by.end(), Index{-1}); }
  bool free(Index disk) const { return driven_by[at(disk)] < 0; }
};

/// Impulse that a contact carried, with its ends: disks by their number, wall w as disks() + w; a < b.
struct RememberedImpulse {
  Index a = 0, b = 0;
  LocalVector<2> impulse;  ///< N s
};

/// Interface impulse that held the copy of a grain in a subdomain, (A_E^T F_Gamma) of that copy, N s.
struct RememberedGluing {
  Index grain = 0, subdomain = 0;
  double x = 0, y = 0, rim = 0;
};

/// Subdomain that a contact was given at the last decomposition.
struct RememberedSubdomain {
  Index a = 0, b = 0, subdomain = 0;
};

/// How a subdomain was modelled in the last step of a run that switches models.
struct RememberedModel {
  Index switched = 0;             ///< 1 if it ended the step with the simpler model, 0 if with the law itself
  Index standing = 0;             ///< iterations, over steps, for which none of its statuses has changed
  Index switched_iterations = 0;  ///< of the step, in which it had the simpler model
  Index switch_backs = 0;         ///< of the step
  /// Largest distance of the simpler model from the law, at a switch back and at the end, see ModelSwitch.
  double velocity_distance = 0;  ///< m/s
  double impulse_distance = 0;   ///< relative to the interface impulses
};

/// Everything that changes in a run. A run that goes on from it repeats every bit.
struct GranularState {
  Index step = 0;                               ///< steps done
  double time = 0;                              ///< s
  std::vector<double> x, y, angle;              ///< of every disk, m and rad
  std::vector<double> velocity_x, velocity_y;   ///< m/s
  std::vector<double> spin;                     ///< rad/s
  std::vector<Pose> poses;                      ///< of every boundary
  std::vector<RememberedImpulse> impulses;      ///< of the last step, ascending by (a, b)
  std::vector<RememberedGluing> gluing;         ///< of the last step, ascending by (grain, subdomain)
  std::vector<RememberedSubdomain> subdomains;  ///< of the contacts of the last step, ascending by (a, b)
  std::vector<RememberedModel> models;          ///< of the subdomains, in their order; empty unless they are switched
  Index decomposed_at = -1;                     ///< step whose contacts were partitioned afresh last
  double eta = 0;                               ///< best flexibility found at that step, 1/kg; 0 if none was asked for
};

/// Velocities of all boundaries at a time, s.
std::vector<RigidVelocity> boundary_velocities(const GranularSystem& system, double time);

/// The state at time 0: grains are at rest at their places in the packing, boundaries at their centres.
GranularState initial_state(const GranularSystem& system, std::vector<double> x, std::vector<double> y);

/// "disk 3", "disk 130 of boundary 'left'", or "the wall of boundary 'right'" for body disks() + its number.
std::string body_name(const GranularSystem& system, Index body);

/// Throws Error naming the disk or boundary if sizes differ, a number is not finite, a disk is driven by a boundary
/// that does not exist, or no disk is free.
void check(const GranularSystem& system, const GranularState& state);

}  // namespace nscdd
