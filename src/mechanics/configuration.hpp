// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/time_stepping.hpp"

namespace nscdd {

/// Where everything is at one time.
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

/// Where everything is `time` after the state, at the velocities of the state and those of the boundaries.
template <int D>
Configuration<D> middle(const GranularSystem& system, const GranularState& state,
                        const std::vector<RigidVelocity>& motions, double time);

/// Where a grain meets a wall: the nearest point of the wall, and the distance of the centre, > 0 on the grains' side.
template <int D>
struct WallPoint {
  Direction<D> foot, normal;  ///< the normal points to the grain
  double height;              ///< m
};
template <int D>
WallPoint<D> nearest_point(const Wall& wall, const Direction<D>& centre);

/// The smaller radius of grain a and body b, m: that of the grain where b is a wall.
double smaller_radius(const GranularSystem& system, Index a, Index b);

template <int D>
double dot(const Direction<D>& a, const Direction<D>& b) {
  double sum = a[0] * b[0] + a[1] * b[1];
  if constexpr (D == 3) sum += a[2] * b[2];
  return sum;
}

template <int D>
double length(const Direction<D>& a) {
  if constexpr (D == 2)
    return std::hypot(a[0], a[1]);
  else
    return std::hypot(a[0], a[1], a[2]);
}

/// a + factor b
template <int D>
Direction<D> moved_along(Direction<D> a, double factor, const Direction<D>& b) {
  for (std::size_t k = 0; k < D; ++k) a[k] += factor * b[k];
  return a;
}

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

}  // namespace nscdd
