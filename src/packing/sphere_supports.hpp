// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <Eigen/Geometry>

namespace nscdd {

using SpacePoint = Eigen::Vector3d;

/// Obstacle for the centre of a sphere: the ball about another sphere, or a plane. Floor and walls have negative
/// numbers, grains their own.
///
///   gap(c) = |c - s| - (r + r_s)  or  n . c - offset,     normal(c) = grad gap
struct Obstacle {
  static constexpr Index floor = -1;
  Index number = floor;
  bool plane = true;
  SpacePoint at = SpacePoint::UnitZ();  ///< centre s of the sphere, or normal n of the plane
  double reach = 0;                     ///< r + r_s, or offset, m

  double gap(const SpacePoint& c) const { return plane ? at.dot(c) - reach : (c - at).norm() - reach; }
  SpacePoint normal(const SpacePoint& c) const { return plane ? at : SpacePoint((c - at).normalized()); }
};

/// Obstacles that support a sphere in steepest descent, and its velocity v: -e_z projected on the cone
/// {v : n_k . v >= 0 for all k},
///
///   v = -e_z + sum_k lambda_k n_k,   lambda_k >= 0,   n_k . v >= 0,   lambda_k n_k . v = 0,
///
/// by trying the sets of zero to three obstacles, the smallest first. Those with lambda_k > 0 support it; v = 0 is
/// rest: its centre is then above the triangle of the points of contact of three independent supports.
struct Carried {
  std::array<std::size_t, 3> by{};  ///< positions of the supports
  std::size_t supports = 0;
  SpacePoint velocity = -SpacePoint::UnitZ();

  bool has(std::size_t k) const { return std::ranges::count(std::span(by).first(supports), k) > 0; }
};
/// `but`: sets to skip. If several give one velocity, with multipliers of 0, the curvature of their arcs decides.
Carried carried_by(std::span<const SpacePoint> normals, std::span<const Carried> but = {});

/// First angle >= 0 at which q_u cos + q_w sin rises to |q| - excess: infinite for an excess <= 0, 0 if already above.
double first_crossing(double q_u, double q_w, double excess);

/// Moves the centre of a sphere to the nearest point where all gaps vanish, by two Newton steps of least length.
void touch_exactly(SpacePoint& centre, std::span<const Obstacle> obstacles, double radius);

/// Speed, relative to that of a fall, below which rounding hides the direction of descent: the sphere is on a crest.
inline constexpr double crest = 1e-7;

}  // namespace nscdd
