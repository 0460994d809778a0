// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "packing/bed_cells.hpp"

namespace nscdd {

struct Disk {
  double x = 0, y = 0, radius = 0;  ///< m
};

using Point = std::array<double, 2>;

/// Height of the centre at which a disk that falls along x meets `support`; empty if it passes by:
///   y = y_s + sqrt((R - d)(R + d)),  R = r + r_s,  d = |x - x_s|.
std::optional<double> fall_onto(const Disk& support, double x, double radius);

enum class Side { left = -1, right = 1 };  ///< direction in which a disk rolls over another: to the right is clockwise

/// First contact of a disk, rolling over `pivot` to that side, with `other`: the point at distance r + r_p from the
/// pivot and r + r_o from the other. Empty if the disk passes between them without touching.
std::optional<Point> roll_against(const Disk& pivot, const Disk& other, double radius, Side side);

/// A bed of disks in a box, built by drop and roll.
class Heap {
 public:
  /// A box with the floor y = 0 and walls x = 0 and x = width, m. `radii`: of the grains to come, m.
  Heap(double width, double largest_radius, std::vector<double> radii)
      : width_(width), cells_(width, 0, largest_radius, std::move(radii)) {}

  /// Rest position of a disk dropped at x: on the floor, or on two supports (grains, or a grain and a wall) with its
  /// centre between them. radius <= x <= width - radius, radius <= largest_radius.
  Disk settle(double x, double radius) const;

  void add(const Disk& disk);

 private:
  /// The obstacle that a disk met, and the centre of the disk.
  struct Meeting {
    enum class With { nothing, floor, wall, grain } with;
    Point centre;
    Index grain = -1;
  };
  Meeting fall(const Point& from, double radius) const;
  Meeting roll(const Disk& pivot, const Point& from, double radius, Side side) const;
  Meeting end_of_roll(const Disk& pivot, double radius, Side side) const;
  enum class Rows { upwards, downwards };
  bool first_met(double lead, Index i, const Meeting& met, Rows rows) const;

  double width_;
  BedCells cells_;
  std::vector<Disk> disks_;
};

}  // namespace nscdd
