// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace nscdd {

struct Disk {
  double x = 0, y = 0, radius = 0;  ///< m
};

using Point = std::array<double, 2>;

/// Height of the centre at which a disk of that radius, falling along x, meets `support`; empty where it
/// passes by:  y = y_s + sqrt((R - d)(R + d)),  R = r + r_s,  d = |x - x_s|.
std::optional<double> fall_onto(const Disk& support, double x, double radius);

/// Which way a disk rolls over another: to the right is clockwise.
enum class Side { left = -1, right = 1 };

/// Where a disk of that radius, rolling over `pivot` to that side, meets `other`: of the two points at
/// distance r + r_p from the pivot and r + r_o from the other, the one met first. Empty where the disk passes
/// between them without touching.
std::optional<Point> roll_against(const Disk& pivot, const Disk& other, double radius, Side side);

/// The bed of a box that grains are dropped into, in square cells as wide as the largest grain, so that a
/// grain finds those near it at a cost that does not grow with the bed.
class Heap {
 public:
  /// A box with the floor y = 0 and walls x = 0 and x = width, m; `grains` is what to make room for.
  Heap(double width, double largest_radius, Index grains);

  /// Where a disk dropped at x comes to rest: on the floor, or on two supports (grains, or a grain and a
  /// wall) with its centre between them. radius <= x <= width - radius, radius <= largest_radius.
  Disk settle(double x, double radius) const;

  void add(const Disk& disk);

 private:
  /// What a disk met, and where its centre was then.
  struct Meeting {
    enum class With { nothing, floor, wall, grain } with;
    Point centre;
    std::int32_t grain = -1;
  };
  Meeting fall(const Point& from, double radius) const;
  Meeting roll(const Disk& pivot, const Point& from, double radius, Side side) const;
  Meeting end_of_roll(const Disk& pivot, double radius, Side side) const;

  std::size_t column_of(double x) const;
  std::size_t row_of(double y) const;
  template <class Visit>
  void visit_cell(std::size_t column, std::size_t row, Visit&& visit) const;

  double width_, largest_, side_;
  std::size_t columns_, rows_ = 0;
  std::vector<Disk> disks_;
  std::vector<std::int32_t> first_, next_;  ///< lists of grains: first of each cell, next of each grain
  std::vector<std::size_t> filled_;         ///< of each column: rows up to its highest grain
};

}  // namespace nscdd
