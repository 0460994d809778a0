// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/time_stepping.hpp"

#include <vector>

namespace nscdd {

/// Where everything is when contacts are found.
struct Configuration {
  std::vector<double> x, y;            ///< of every disk at q_m, m
  std::vector<Wall> walls;             ///< at q_m
  std::vector<Pose> poses;             ///< of boundaries at q_m
  std::vector<RigidVelocity> motions;  ///< of boundaries in this step
};

/// Pairs of a free disk and a disk or wall, ascending by (a, b), whose gap is within the alert distance, or
/// would be after the step at the velocities V^- + h g and those of the boundaries. `least_alert`, m,
/// replaces an alert distance of the scheme that is smaller. Throws Error naming both disks if two have the
/// same centre.
std::vector<StepContact> find_contacts(const GranularSystem& system, const Configuration& where,
                                       const std::vector<DiskVelocity>& free, const TimeStepping& scheme,
                                       double least_alert = 0);

}  // namespace nscdd
