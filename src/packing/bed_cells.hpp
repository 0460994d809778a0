// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Area of disks of these radii, m^2, or volume of spheres, m^3; overlaps counted twice.
double total_measure(std::span<const double> radii, bool in_space);

/// Relative enlargement of sizes for a search, far more than the rounding of coordinates.
constexpr double size_margin = 1e-6;

/// Grains of a growing bed in square or cubic cells. Each level has the grains of one range of sizes, in cells as wide
/// as the largest of them. A moving grain searches only the cells along its path: the cost per grain does not grow with
/// the bed, and little with the ratio of sizes. Places are (x, y, height), m, y = 0 in the plane.
class BedCells {
 public:
  /// The base of the bed, m, of depth 0 in the plane. `radii`: of the grains to come, m.
  BedCells(double width, double depth, double largest_radius, std::vector<double> radii);

  /// Cells of the grains up to one size, except for those on finer levels. Layers are added as the bed grows.
  struct Level {
    double largest, side;  ///< m
    std::size_t columns, rows, layers = 0;
    std::vector<std::int32_t> first = {};  ///< latest grain of each cell, layer by layer; -1 for none
    std::vector<std::size_t> filled = {};  ///< of each column of cells: layers up to its highest grain

    std::size_t column_of(double x) const { return std::min(columns - 1, layer_of(x)); }
    std::size_t row_of(double y) const { return std::min(rows - 1, layer_of(y)); }
    std::size_t layer_of(double height) const { return static_cast<std::size_t>(std::max(0.0, height) / side); }

    /// Calls visit(column) for the columns of cells between two places, row by row.
    void for_columns(const Eigen::Vector3d& low, const Eigen::Vector3d& high, auto&& visit) const {
      const std::size_t left = column_of(low.x()), right = column_of(high.x()), back = row_of(high.y());
      for (std::size_t row = row_of(low.y()); row <= back; ++row)
        for (std::size_t column = row * columns + left; column <= row * columns + right; ++column) visit(column);
    }
    /// Layers up to the highest grain of these columns.
    std::size_t highest(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const {
      std::size_t top = 0;
      for_columns(low, high, [&](std::size_t column) { top = std::max(top, filled[column]); });
      return top;
    }
  };
  const std::vector<Level>& levels() const { return levels_; }  ///< coarsest first

  void add(const Eigen::Vector3d& place, double radius);  ///< the next grain, counted from 0

  /// Calls visit(grain) for the grains of a level in the columns between two places and in layers bottom ... top - 1.
  void visit(const Level& level, std::size_t bottom, std::size_t top, const Eigen::Vector3d& low,
             const Eigen::Vector3d& high, auto&& visit) const {
    level.for_columns(low, high, [&](std::size_t column) {
      for (std::size_t layer = std::min(top, level.filled[column]); layer-- > bottom;)
        for (std::int32_t i = level.first[layer * level.filled.size() + column]; i >= 0; i = next_[at(i)])
          visit(Index{i});
    });
  }

 private:
  std::vector<Level> levels_;
  std::vector<std::int32_t> next_;  // of each grain: the previous one in its cell, or -1
};

}  // namespace nscdd
