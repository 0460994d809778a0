// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

struct Disk {
  double x = 0, y = 0, radius = 0;  ///< m
};

using Point = std::array<double, 2>;

/// Height of the centre at which a disk of that radius, falling along x, meets `support`, unless it passes by:
///   y = y_s + sqrt((R - d)(R + d)),  R = r + r_s,  d = |x - x_s|.
std::optional<double> fall_onto(const Disk& support, double x, double radius);

/// Direction in which a disk rolls over another: to the right is clockwise.
enum class Side { left = -1, right = 1 };

/// First contact of a disk, rolling over `pivot` to that side, with `other`: the point at distance r + r_p from the
/// pivot and r + r_o from the other. Empty if the disk passes between them without touching.
std::optional<Point> roll_against(const Disk& pivot, const Disk& other, double radius, Side side);

/// Area of disks of these radii, overlaps counted twice, m^2.
double disk_area(std::span<const double> radii);

/// A bed of disks in a box, built by drop and roll. Grains lie in square cells, level by level: each level has the
/// grains of one range of sizes, in cells as wide as the largest of them. A moving grain searches only the cells along
/// its path: the cost per grain does not grow with the bed, and little with the ratio of sizes.
class Heap {
 public:
  /// A box with the floor y = 0 and walls x = 0 and x = width, m. Cells suit the `radii`, m, of the grains to come.
  Heap(double width, double largest_radius, std::vector<double> radii);

  /// Rest position of a disk dropped at x: on the floor, or on two supports (grains, or a grain and a wall) with its
  /// centre between them. radius <= x <= width - radius, radius <= largest_radius.
  Disk settle(double x, double radius) const;

  void add(const Disk& disk);

 private:
  /// The obstacle that a disk met, and its centre then.
  struct Meeting {
    enum class With { nothing, floor, wall, grain } with;
    Point centre;
    std::int32_t grain = -1;
  };
  /// Cells of the grains up to one size that no finer level takes. Rows are added as the bed grows.
  struct Level {
    double largest, side;  ///< m
    std::size_t columns, rows = 0;
    std::vector<std::int32_t> first = {};  ///< latest grain of each cell, row by row; -1 for none
    std::vector<std::size_t> filled = {};  ///< of each column: rows up to its highest grain

    std::size_t column_of(double x) const;
    std::size_t row_of(double y) const;
  };
  void add_level(double largest, double side);
  Meeting fall(const Point& from, double radius) const;
  Meeting roll(const Disk& pivot, const Point& from, double radius, Side side) const;
  Meeting end_of_roll(const Disk& pivot, double radius, Side side) const;
  enum class Rows { upwards, downwards };
  bool first_met(double lead, std::int32_t i, const Meeting& met, Rows rows) const;
  template <class Visit>
  void visit_row(const Level& level, std::size_t row, double left, double right, Visit&& visit) const;

  double width_;
  std::vector<Level> levels_;  ///< coarsest first
  std::vector<Disk> disks_;
  std::vector<std::int32_t> next_;  ///< of each grain: the previous one in its cell, or -1
};

}  // namespace nscdd
