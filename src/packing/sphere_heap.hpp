// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "packing/sphere_supports.hpp"

namespace nscdd {

struct Sphere {
  SpacePoint centre;
  double radius = 0;  ///< m
};

/// Work that beds were made with.
struct RollingWork {
  Index motions = 0;     ///< falls, and arcs of circles
  Index candidates = 0;  ///< pairs of a motion and a grain that may be in its way
  Index abandoned = 0;   ///< drops without an end, see SphereHeap::settle
};

/// A bed of spheres in a box that more of them are dropped into: the floor z = 0, walls x = 0, x = width, y = 0,
/// y = depth. Its grains lie in cubic cells, level by level as in Heap: a motion searches only the cells along its way.
class SphereHeap {
 public:
  /// Sizes in m. Cells are cut for the `radii` of what will come.
  SphereHeap(double width, double depth, double largest_radius, std::vector<double> radii);

  /// The floor alone; or three that hold a sphere, with its centre above the triangle of the points of contact.
  using Supports = std::vector<Index>;
  struct Rest {
    SpacePoint centre;
    Supports supports;
  };
  /// Where a sphere dropped at (x, y) comes to rest by steepest descent: it falls, rolls over one obstacle down its
  /// meridian, or over two on the circle that touches both, and at every touch and every loss of one carried_by says
  /// what carries it on. Empty for one that has no end within the most motions allowed: where grains lie so exactly in
  /// line that rounding decides on their order over and over. radius <= x <= width - radius, y likewise.
  std::optional<Rest> settle(double x, double y, double radius);

  void add(const Sphere& sphere);

  const RollingWork& work() const { return work_; }

 private:
  struct Level {
    double largest, side;  ///< m
    std::size_t columns, rows, layers = 0;
    std::vector<std::int32_t> first = {};  ///< latest grain of each cell, layer by layer; -1 for none
    std::vector<std::size_t> filled = {};  ///< of each column of cells: layers up to its highest grain

    std::size_t column_of(double x) const { return along(x, columns); }
    std::size_t row_of(double y) const { return along(y, rows); }
    std::size_t layer_of(double z) const { return static_cast<std::size_t>(std::max(0.0, z) / side); }
    std::size_t along(double offset, std::size_t cells) const {
      return std::min(cells - 1, static_cast<std::size_t>(std::max(0.0, offset) / side));
    }
  };
  /// A circle that the centre moves on: centre + radius (cos(angle) outwards + sin(angle) ahead), from angle 0.
  struct Arc {
    SpacePoint centre, outwards, ahead;
    double radius = 0;
    SpacePoint at(double angle) const {
      return centre + radius * (std::cos(angle) * outwards + std::sin(angle) * ahead);
    }
  };
  /// A sphere on its way: what it touches, and what stopped carrying it as its last arc ended.
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

  void add_level(double largest, double side);
  double rounding(double height) const;
  Obstacle wall(Index number, double radius) const;
  Obstacle around(Index grain, double radius) const;
  void fall(Traveller& one);
  /// False for an arc that meets what was touched already as it begins: then other supports carry.
  bool roll(Traveller& one, const Step& step);
  std::optional<Step> next_step(const Traveller& one, const Carried& carried,
                                std::span<const SpacePoint> normals) const;
  SpacePoint in_box(const Traveller& one) const;
  Rest at_rest(Traveller& one, const Carried& carried) const;
  template <class Visit>
  void visit_box(const Level& level, const SpacePoint& low, const SpacePoint& high, Visit&& visit);

  double width_, depth_;
  std::vector<Level> levels_;  ///< coarsest first
  std::vector<Sphere> spheres_;
  std::vector<std::int32_t> next_;  ///< of each grain: the one before it in its cell, or -1
  RollingWork work_;
};

}  // namespace nscdd
