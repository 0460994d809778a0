// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Points by their coordinates, m; no z in the plane.
struct Places {
  std::span<const double> x, y, z = {};

  std::array<double, 3> operator[](std::size_t i) const { return {x[i], y[i], z.empty() ? 0 : z[i]}; }
};

/// Some grains of a packing, or their images.
struct NumberedGrains {
  bool in_space = false;
  std::vector<double> x{}, y{}, z{}, radius{};  ///< m; no z in the plane
  std::vector<Index> number{};                  ///< in the packing

  void add(const std::array<double, 3>& centre, double of_radius, Index of_number);
  Places places() const { return {x, y, z}; }
};

/// Cell grid for neighbour searches in O(N): points sorted into squares or cubes of at least a given side. Cells grow
/// in a sparse or elongated cloud, so that there are at most about two per point.
class CellGrid {
 public:
  /// Coordinates of at least one point, finite and of the same length; side > 0, m.
  CellGrid(const Places& places, double side);

  /// Calls visit(i, j), i < j, for every pair no farther apart than `side` in all coordinates, and some that are.
  void for_each_pair(auto&& visit) const {
    for (Index layer = 0; layer < layers_; ++layer)
      for (Index row = 0; row < rows_; ++row)
        for (Index column = 0; column < columns_; ++column) visit_cell(column, row, layer, visit);
  }

  /// Calls visit(i) for every point no farther than `distance` from a place in all coordinates, and some that are.
  void for_each_near(const std::array<double, 3>& place, double distance, auto&& visit) const {
    distance += rounding * side_;
    const auto [x, y, z] = place;
    const Index first = along(x - low_[0] - distance, columns_), last = along(x - low_[0] + distance, columns_);
    const Index low = along(y - low_[1] - distance, rows_), high = along(y - low_[1] + distance, rows_);
    const Index top = along(z - low_[2] + distance, layers_);
    for (Index layer = along(z - low_[2] - distance, layers_); layer <= top; ++layer)
      for (Index row = low; row <= high; ++row)
        for (Index column = first; column <= last; ++column)
          for (const Index i : cell(column, row, layer)) visit(i);
  }

  const std::vector<Index>& points() const { return points_; }

  /// Average number of points in the cell of a point, itself included: the cost of a search.
  double crowd() const {
    double sum = 0;
    for (std::size_t c = 0; c + 1 < start_.size(); ++c) {
      const auto here = static_cast<double>(start_[c + 1] - start_[c]);
      sum += here * here;
    }
    return sum / std::max(1.0, static_cast<double>(points_.size()));
  }

 private:
  static constexpr double rounding = 1e-9;  ///< of a side, more than that of coordinates

  // The pairs of a cell, and those with half of its neighbours; the other half visit this cell.
  void visit_cell(Index column, Index row, Index layer, auto& visit) const {
    const auto here = cell(column, row, layer);
    for (std::size_t a = 0; a < here.size(); ++a)
      for (std::size_t b = a + 1; b < here.size(); ++b) visit(here[a], here[b]);
    constexpr Index ahead[13][3] = {{1, 0, 0},  {-1, 1, 0}, {0, 1, 0}, {1, 1, 0},  {-1, -1, 1}, {0, -1, 1}, {1, -1, 1},
                                    {-1, 0, 1}, {0, 0, 1},  {1, 0, 1}, {-1, 1, 1}, {0, 1, 1},   {1, 1, 1}};
    for (const auto& step : std::span(ahead).first(layers_ == 1 ? 4 : 13)) {
      const Index c = column + step[0], r = row + step[1], l = layer + step[2];
      if (c < 0 || c >= columns_ || r < 0 || r >= rows_ || l >= layers_) continue;
      for (const Index i : here)
        for (const Index j : cell(c, r, l)) visit(std::min(i, j), std::max(i, j));
    }
  }
  // The cell at an offset from the lower end of the table; clamped to the first or last one.
  Index along(double offset, Index cells) const {
    return static_cast<Index>(std::clamp(offset / side_, 0.0, static_cast<double>(cells - 1)));
  }
  std::span<const Index> cell(Index column, Index row, Index layer) const {
    const Index c = (layer * rows_ + row) * columns_ + column;
    return std::span(points_).subspan(at(start_[at(c)]), at(start_[at(c + 1)] - start_[at(c)]));
  }

  Index columns_ = 1, rows_ = 1, layers_ = 1;
  std::array<double, 3> low_{};
  double side_ = 1;
  std::vector<Index> start_;   ///< first point of each cell, one more at the end
  std::vector<Index> points_;  ///< indices, cell by cell, ascending within a cell
};

/// Grids for neighbour searches among grains of sizes 1 : ratio, in O(N log ratio). One CellGrid with cells for the
/// largest grain serves all unless its cells are crowded, by up to ratio^2 disks or ratio^3 spheres. Then grains within
/// a factor 2 of the largest have their own grid, the others a grid for the largest of them, and so on. Each grain is
/// compared with those of its own grid and of the coarser ones.
class GrainGrid {
 public:
  /// places: centres, m; radius > 0, m; all finite and of the same length; stretch >= 1, range >= 0, m.
  GrainGrid(Places places, std::span<const double> radius, double stretch = 1, double range = 0);

  /// Calls visit(i, j), i < j, once for pairs of distance <= stretch (radius_i + radius_j) + range, and some others.
  void for_each_pair(auto&& visit) const {
    if (levels_.size() == 1) return levels_.front().grid.for_each_pair(visit);
    for (std::size_t fine = 0; fine < levels_.size(); ++fine) {
      const NumberedGrains& grains = levels_[fine].grains;
      levels_[fine].grid.for_each_pair([&](Index a, Index b) { visit(grains.number[at(a)], grains.number[at(b)]); });
      for (std::size_t coarse = 0; coarse < fine; ++coarse) {
        const Level& other = levels_[coarse];
        const double distance = levels_[fine].largest + other.largest;
        for (const Index a : levels_[fine].grid.points()) {  // by cells: neighbours are adjacent
          const Index i = grains.number[at(a)];
          other.grid.for_each_near(grains.places()[at(a)], distance, [&](Index b) {
            const Index j = other.grains.number[at(b)];
            visit(std::min(i, j), std::max(i, j));
          });
        }
      }
    }
  }

 private:
  struct Level {
    NumberedGrains grains;  // ascending; empty if one level holds all
    double largest;         // radius, stretched, and half the range
    CellGrid grid;
  };
  std::vector<Level> levels_;  // coarsest first
};

/// The grains of a periodic cell, each at its image in the cell, and behind them images beyond the ends of the cell of
/// those that are within `reach` of its beginnings: every near pair has two such neighbours, one of them in the cell.
NumberedGrains periodic_grains(const Places& places, std::span<const double> radius, const Period& period,
                               double reach);

/// Calls visit(i, j), i < j, as GrainGrid::for_each_pair, also for grains that are near across ends of a periodic cell.
void for_each_near_pair(const Places& places, std::span<const double> radius, const Period& period, double stretch,
                        double range, auto&& visit) {
  if (!period.any() || radius.empty()) return GrainGrid(places, radius, stretch, range).for_each_pair(visit);
  const double reach = 2 * stretch * *std::max_element(radius.begin(), radius.end()) + range;
  const NumberedGrains all = periodic_grains(places, radius, period, reach);
  const GrainGrid grid(all.places(), all.radius, stretch, range);
  const auto grains = static_cast<Index>(radius.size());
  // A long range may meet a pair twice: the shortest vector is that of one meeting alone.
  const auto shortest = [](double d, double length) { return length == 0 || (d > -length / 2 && d <= length / 2); };
  grid.for_each_pair([&](Index p, Index q) {
    if (p >= grains && q >= grains) return;
    Index i = all.number[at(p)], j = all.number[at(q)];
    if (i == j) return;
    if (i > j) std::swap(i, j), std::swap(p, q);
    if (shortest(all.x[at(q)] - all.x[at(p)], period.x) && shortest(all.y[at(q)] - all.y[at(p)], period.y)) visit(i, j);
  });
}

/// Sorts contacts (anything with members a and b) by (a, b) in O(N): a counting sort by a, 0 <= a < bodies, then by b.
template <class AnyContact>
std::vector<AnyContact> sorted_by_bodies(const std::vector<AnyContact>& contacts, Index bodies) {
  std::vector<Index> next(at(bodies) + 1, 0);  // place of the next contact of a, finally the end of its contacts
  for (const AnyContact& contact : contacts) ++next[at(contact.a) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::int32_t> order(contacts.size());
  for (std::size_t k = 0; k < contacts.size(); ++k) order[at(next[at(contacts[k].a)]++)] = static_cast<std::int32_t>(k);
  for (Index a = 0, first = 0; a < bodies; first = next[at(a)], ++a)
    std::ranges::sort(order.begin() + first, order.begin() + next[at(a)], {},
                      [&](std::int32_t k) { return contacts[at(k)].b; });
  std::vector<AnyContact> result;
  result.reserve(contacts.size());
  for (const std::int32_t k : order) result.push_back(contacts[at(k)]);
  return result;
}

}  // namespace nscdd
