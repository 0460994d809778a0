// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/disk_grid.hpp"

namespace nscdd {
namespace {

// Disks in a cell, on average over the disks, beyond which another grid is cheaper. Measured; the value matters little.
constexpr double crowded = 32;

}  // namespace

CellGrid::CellGrid(std::span<const double> x, std::span<const double> y, double side) {
  const auto [x_min, x_max] = std::minmax_element(x.begin(), x.end());
  const auto [y_min, y_max] = std::minmax_element(y.begin(), y.end());
  const double width = *x_max - *x_min, height = *y_max - *y_min;
  x_low_ = *x_min;
  y_low_ = *y_min;
  // A little more than asked, so that rounding never puts two points of distance `side` two cells apart.
  side *= 1 + rounding;
  const double budget = 2.0 * static_cast<double>(x.size()) + 64;
  while ((std::floor(width / side) + 1) * (std::floor(height / side) + 1) > budget) side *= 2;
  columns_ = static_cast<Index>(std::floor(width / side)) + 1;
  rows_ = static_cast<Index>(std::floor(height / side)) + 1;
  side_ = side;

  std::vector<Index> cell_of(x.size());
  start_.assign(at(columns_ * rows_ + 1), 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    cell_of[i] = along(y[i] - y_low_, rows_) * columns_ + along(x[i] - x_low_, columns_);
    ++start_[at(cell_of[i] + 1)];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  points_.resize(x.size());
  std::vector<Index> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < x.size(); ++i) points_[at(next[at(cell_of[i])]++)] = static_cast<Index>(i);
}

DiskGrid::DiskGrid(std::span<const double> x, std::span<const double> y, std::span<const double> radius, double stretch,
                   double range) {
  if (radius.empty()) return;
  Disks rest;
  while (true) {
    const double largest = *std::max_element(radius.begin(), radius.end());
    const double reach = stretch * largest + range / 2;
    const auto coarse_one = [&](double r) { return 2 * r >= largest; };
    CellGrid grid(x, y, 2 * reach);
    if (grid.crowd() <= crowded || std::all_of(radius.begin(), radius.end(), coarse_one)) {
      levels_.push_back({std::move(rest), reach, std::move(grid)});
      return;
    }
    Disks coarse, fine;
    for (std::size_t k = 0; k < radius.size(); ++k) {
      Disks& part = coarse_one(radius[k]) ? coarse : fine;
      part.numbers.push_back(rest.numbers.empty() ? static_cast<Index>(k) : rest.numbers[k]);
      part.x.push_back(x[k]);
      part.y.push_back(y[k]);
      part.radius.push_back(radius[k]);
    }
    CellGrid own(coarse.x, coarse.y, 2 * reach);
    levels_.push_back({std::move(coarse), reach, std::move(own)});
    rest = std::move(fine);
    x = rest.x, y = rest.y, radius = rest.radius;
  }
}

}  // namespace nscdd
