// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <Eigen/Geometry>

namespace nscdd {

using SpacePoint = Eigen::Vector3d;

/// What a sphere touches, as its centre sees it: it keeps out of the ball about another sphere, or on its side of a
/// plane. Floor and walls have negative numbers, grains their own.
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

/// Which of the obstacles carry a sphere that creeps down the steepest way, and where to: v is -e_z projected on the
/// cone {v : n_k . v >= 0 for all k},
///
///   v = -e_z + sum_k lambda_k n_k,   lambda_k >= 0,   n_k . v >= 0,   lambda_k n_k . v = 0,
///
/// found by trying the sets of none to three supports, the smallest first. Those with lambda_k > 0 carry; it is at rest
/// where v = 0. Three that carry independently have its centre above the triangle of the points of contact.
struct Carried {
  std::array<std::size_t, 3> by{};  ///< positions of those that carry
  std::size_t supports = 0;
  SpacePoint velocity = -SpacePoint::UnitZ();

  bool has(std::size_t k) const { return std::ranges::count(std::span(by).first(supports), k) > 0; }
};
/// Sets in `but` are left out: where several sets meet the conditions (with multipliers of 0) they have one velocity,
/// and the curvature of their arcs decides, which the normals do not know.
Carried carried_by(std::span<const SpacePoint> normals, std::span<const Carried> but = {});

/// Where the first angle >= 0 is at which q_u cos(angle) + q_w sin(angle) = a cos(angle - nearest) rises to a - excess,
/// a = hypot(q_u, q_w): infinite for an excess of 0 or less. What is above and still rises is met at once.
double first_crossing(double q_u, double q_w, double excess);

/// Moves the centre of a sphere of that radius to the nearest place at which all gaps vanish, to rounding: Newton's
/// step of least length, twice.
void touch_exactly(SpacePoint& centre, std::span<const Obstacle> obstacles, double radius);

/// Speed, relative to that of a fall, below which a sphere is on a crest: rounding knows no more which way is down.
inline constexpr double crest = 1e-7;

}  // namespace nscdd
