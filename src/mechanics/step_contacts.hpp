// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/time_stepping.hpp"

namespace nscdd {

/// Where everything is when the contacts of a step are found, at q_m.
template <int D>
struct Configuration {
  std::vector<double> x, y, z;         ///< of every grain, m
  std::vector<Wall> walls;             ///< moved
  std::vector<Pose> poses;             ///< of boundaries
  std::vector<RigidVelocity> motions;  ///< of boundaries in this step

  Direction<D> centre(std::size_t i) const {
    if constexpr (D == 2)
      return {x[i], y[i]};
    else
      return {x[i], y[i], z[i]};
  }
};

/// A direction of the dimension as the three numbers of StepContact, and back.
template <int D>
std::array<double, 3> widened(const Direction<D>& a) {
  if constexpr (D == 2)
    return {a[0], a[1], 0};
  else
    return a;
}
template <int D>
Direction<D> narrowed(const std::array<double, 3>& a) {
  if constexpr (D == 2)
    return {a[0], a[1]};
  else
    return a;
}

template <int D>
Direction<D> velocity_of(const GrainVelocity<D>& v) {
  if constexpr (D == 2)
    return {v.x, v.y};
  else
    return {v.x, v.y, v.z};
}

/// |velocity| without the rim, m/s.
template <int D>
double speed_of(const GrainVelocity<D>& v) {
  if constexpr (D == 2)
    return std::hypot(v.x, v.y);
  else
    return std::hypot(v.x, v.y, v.z);
}

/// Where everything is `time` after the state, at the velocities of the state and those of the boundaries.
template <int D>
Configuration<D> middle(const GranularSystem& system, const GranularState& state,
                        const std::vector<RigidVelocity>& motions, double time);

/// Calls visit(contact) for the pairs of a free grain and a grain or wall whose gap is within the alert distance, or
/// would be after the step at the velocities `velocity(grain)`, V^- + h g, and those of the boundaries. `least_alert`,
/// m, replaces an alert distance of the scheme that is smaller. Throws Error naming both grains if two have the same
/// centre.
template <int D>
void for_each_contact(const GranularSystem& system, const Configuration<D>& where,
                      const std::function<Direction<D>(Index)>& velocity, const TimeStepping& scheme,
                      double least_alert, const std::function<void(const StepContact&)>& visit);

}  // namespace nscdd
