// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "packing/bed_cells.hpp"
#include "packing/sphere_supports.hpp"
#include <nscdd/packing/packing.hpp>

namespace nscdd {

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

  /// The floor; or three supports of a sphere, with its centre above the triangle of the points of contact.
  using Supports = std::vector<Index>;
  struct Rest {
    SpacePoint centre;
    Supports supports;
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
  Obstacle wall(Index number, double radius) const;
  Obstacle around(Index grain, double radius) const;
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
  std::vector<SphereHeap::Supports> supports;
  RollingWork work;
};
SphereBed sphere_bed(const SphereDeposit& deposit, const Monitor& monitor = {});

}  // namespace nscdd
