// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/bed_cells.hpp"

#include <numbers>

namespace nscdd {

double total_measure(std::span<const double> radii, bool in_space) {
  double sum = 0;
  for (const double r : radii) sum += in_space ? 4 * std::numbers::pi / 3 * r * r * r : std::numbers::pi * r * r;
  return sum;
}

BedCells::BedCells(double width, double depth, double largest_radius, std::vector<double> radii) {
  next_.reserve(radii.size());
  const bool in_space = depth > 0;
  const double base = in_space ? width * depth : width;
  const auto cells_for = [](std::size_t grains) { return 2.0 * static_cast<double>(grains) + 64; };
  const auto add_level = [&](double largest, double side) {
    const auto cells = [side](double length) { return static_cast<std::size_t>(length / side) + 1; };
    levels_.push_back({.largest = largest, .side = side, .columns = cells(width), .rows = cells(depth)});
    Level& level = levels_.back();
    level.filled.assign(level.columns * level.rows, 0);
  };
  // If grains cannot cover the base, columns are fewer and wider.
  const auto side_for = [&](double largest, std::size_t grains) {
    const double share = base / cells_for(grains);
    return std::max(2 * largest, in_space ? std::sqrt(share) : share);
  };
  add_level(largest_radius, side_for(largest_radius, radii.size()));
  std::sort(radii.begin(), radii.end());
  const double room = std::max(total_measure(radii, in_space), 2 * largest_radius * base);
  while (true) {
    const double largest = levels_.back().largest;
    radii.erase(std::lower_bound(radii.begin(), radii.end(), largest / 2), radii.end());
    // A finer level, where a cell of the largest would hold more than 4 smaller grains (8 in space). 16 are as fast.
    const double square = static_cast<double>(radii.size()) * largest * largest;
    if (radii.empty() || (in_space ? square * largest : square) <= room) return;
    // Slightly larger, so that rounding hides no grain behind a border of cells; wider if there are few grains.
    const double bound = radii.back() * (1 + 1e-6), share = room / cells_for(radii.size());
    add_level(bound, std::max(side_for(bound, radii.size()), in_space ? std::cbrt(share) : std::sqrt(share)));
  }
}

void BedCells::add(const Eigen::Vector3d& place, double radius) {
  auto level = levels_.rbegin();
  while (level->largest < radius) ++level;
  const std::size_t column = level->row_of(place.y()) * level->columns + level->column_of(place.x());
  const std::size_t layer = level->layer_of(place.z());
  level->layers = std::max(level->layers, layer + 1);
  level->first.resize(std::max(level->first.size(), level->layers * level->filled.size()), -1);
  level->filled[column] = std::max(level->filled[column], layer + 1);
  std::int32_t& first = level->first[layer * level->filled.size() + column];
  next_.push_back(first);
  first = static_cast<std::int32_t>(next_.size() - 1);
}

}  // namespace nscdd
