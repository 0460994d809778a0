// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "packing/bed_cells.hpp"
#include <nscdd/packing/packing.hpp>

#include <Eigen/Geometry>

namespace nscdd {

using SpacePoint = Eigen::Vector3d;

/// Obstacle for the centre of a sphere: the ball about another sphere, or a plane (floor and walls: negative numbers).
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

struct Sphere {
  SpacePoint centre;
  double radius = 0;  ///< m
};

struct RollingWork {
  Index motions = 0;     ///< falls, and arcs of circles
  Index candidates = 0;  ///< pairs of a motion and a possible obstacle
  Index abandoned = 0;   ///< drops without an end, see SphereHeap::settle
};

/// A bed of spheres in a box, built by drop and roll: floor z = 0, walls x = 0, x = width, y = 0, y = depth.
class SphereHeap {
 public:
  /// Sizes in m. `radii`: of the grains to come.
  SphereHeap(double width, double depth, double largest_radius, std::vector<double> radii)
      : width_(width), depth_(depth), cells_(width, depth, largest_radius, std::move(radii)) {}

  struct Rest {
    SpacePoint centre;
    std::vector<Index> supports;  ///< the floor; or three, with the centre above the triangle of the points of contact
  };
  /// Rest position of a sphere dropped at (x, y), by steepest descent: it falls, rolls over one obstacle along its
  /// meridian, or over two on the circle that touches both; `carried_by` finds the next supports at every new or lost
  /// contact. radius <= x <= width - radius, y likewise. Empty if it never rests within a limit of motions: the order
  /// of exactly aligned grains may depend on rounding again and again.
  std::optional<Rest> settle(double x, double y, double radius);

  void add(const Sphere& sphere);

  const RollingWork& work() const { return work_; }

 private:
  /// A circle that the centre moves on: centre + radius (cos(angle) outwards + sin(angle) ahead), from angle 0.
  struct Arc {
    SpacePoint centre, outwards, ahead;
    double radius = 0;
    SpacePoint at(double angle) const {
      return centre + radius * (std::cos(angle) * outwards + std::sin(angle) * ahead);
    }
  };
  /// A moving sphere: its contacts, and the support it lost at the end of its last arc.
  struct Traveller {
    SpacePoint centre;
    double radius = 0;
    std::vector<Obstacle> touched = {};
    std::optional<Index> left = std::nullopt;
  };
  struct Step {
    Arc arc;
    std::array<Obstacle, 2> pivots;
    std::size_t count = 0;
  };

  double rounding(double height) const;
  Obstacle obstacle(Index number, double radius) const;
  void fall(Traveller& one);
  /// False if the arc at once meets an obstacle already touched: other supports then carry the sphere.
  bool roll(Traveller& one, const Step& step);
  std::optional<Step> next_step(const Traveller& one, const Carried& carried,
                                std::span<const SpacePoint> normals) const;
  SpacePoint in_box(const Traveller& one) const;
  Rest at_rest(Traveller& one, const Carried& carried) const;

  double width_, depth_;
  BedCells cells_;
  std::vector<Sphere> spheres_;
  RollingWork work_;
};

struct SphereDeposit;

struct SphereBed {
  Packing packing;
  double width = 0, depth = 0;  ///< m
  std::vector<std::vector<Index>> supports;
  RollingWork work;
};
SphereBed sphere_bed(const SphereDeposit& deposit, const Monitor& monitor = {});

}  // namespace nscdd
