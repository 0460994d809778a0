// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/time_stepping.hpp>

#include <vector>

namespace nscdd {

/// Where everything is when contacts are found.
struct Configuration {
  std::vector<double> x, y;            ///< of every disk at q_m, m
  std::vector<Wall> walls;             ///< at q_m
  std::vector<Pose> poses;             ///< of boundaries at q_m
  std::vector<RigidVelocity> motions;  ///< of boundaries in this step
};

/// Pairs of a free disk and a disk or wall that are within the alert distance (`least_alert`, m, where that
/// of the scheme is smaller), or would be after the step at the velocities V^- + h g and those of boundaries,
/// ascending by (a, b). Throws Error naming both disks of a pair with one centre.
std::vector<StepContact> find_contacts(const GranularSystem& system, const Configuration& where,
                                       const std::vector<DiskVelocity>& free, const TimeStepping& scheme,
                                       double least_alert = 0);

}  // namespace nscdd
