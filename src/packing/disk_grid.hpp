// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "packing/cell_grid.hpp"
#include <nscdd/core/types.hpp>

#include <span>
#include <vector>

namespace nscdd {

/// Disks of any sizes, for neighbour searches in O(N log ratio). One CellGrid with cells for the largest disk
/// serves them all unless its cells are crowded, as sizes 1 : ratio can fill them with ratio^2 disks; then
/// the disks within a factor 2 of the largest have that grid to themselves, the others a grid for the largest
/// of them, and so on. Each disk meets those of its own grid and of the coarser ones.
class DiskGrid {
 public:
  /// x, y: centres, m; radius > 0, m; all finite and of the same length; stretch >= 1, range >= 0, m.
  DiskGrid(std::span<const double> x, std::span<const double> y, std::span<const double> radius,
           double stretch = 1, double range = 0);

  /// Calls visit(i, j), i < j, once for every pair whose centres are no farther apart than
  /// stretch (radius_i + radius_j) + range, and once for some that are.
  template <class Visit>
  void for_each_pair(Visit&& visit) const {
    if (levels_.size() == 1) return levels_.front().grid.for_each_pair(visit);
    for (std::size_t fine = 0; fine < levels_.size(); ++fine) {
      const Level& level = levels_[fine];
      level.grid.for_each_pair([&](Index a, Index b) { visit(level.disks[at(a)], level.disks[at(b)]); });
      for (std::size_t coarse = 0; coarse < fine; ++coarse) {
        const Level& other = levels_[coarse];
        const double distance = level.largest + other.largest;
        for (const Index a : level.grid.points()) {  // by cells: neighbours after each other
          const Index i = level.disks[at(a)];
          other.grid.for_each_near(level.x[at(a)], level.y[at(a)], distance, [&](Index b) {
            const Index j = other.disks[at(b)];
            i < j ? visit(i, j) : visit(j, i);
          });
        }
      }
    }
  }

 private:
  struct Level {
    std::vector<Index> disks;  // ascending; not needed, and empty, where one level holds all
    std::vector<double> x, y;
    double largest;  // radius, stretched, and half the range
    CellGrid grid;
  };
  std::vector<Level> levels_;  // coarsest first
};

}  // namespace nscdd
