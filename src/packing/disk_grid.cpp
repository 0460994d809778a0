// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/disk_grid.hpp"

#include <algorithm>

namespace nscdd {
namespace {

// Disks in the cell of each, beyond which another grid is the cheaper way: measured, and of no great weight.
constexpr double crowded = 32;

struct Disks {
  std::vector<Index> numbers;
  std::vector<double> x, y, radius;

  void add(Index number, double x_new, double y_new, double radius_new) {
    numbers.push_back(number);
    x.push_back(x_new);
    y.push_back(y_new);
    radius.push_back(radius_new);
  }
};

}  // namespace

DiskGrid::DiskGrid(std::span<const double> x, std::span<const double> y, std::span<const double> radius,
                   double stretch, double range) {
  if (radius.empty()) return;
  Disks rest;
  while (true) {
    const double largest = *std::max_element(radius.begin(), radius.end()),
                 reach = stretch * largest + range / 2;
    const auto coarse_one = [&](double r) { return 2 * r >= largest; };
    CellGrid grid(x, y, 2 * reach);
    if (grid.crowd() <= crowded || std::all_of(radius.begin(), radius.end(), coarse_one)) {
      levels_.push_back(
          {std::move(rest.numbers), std::move(rest.x), std::move(rest.y), reach, std::move(grid)});
      return;
    }
    Disks coarse, fine;
    for (std::size_t k = 0; k < radius.size(); ++k) {
      const Index number = rest.numbers.empty() ? static_cast<Index>(k) : rest.numbers[k];
      (coarse_one(radius[k]) ? coarse : fine).add(number, x[k], y[k], radius[k]);
    }
    CellGrid own(coarse.x, coarse.y, 2 * reach);
    levels_.push_back(
        {std::move(coarse.numbers), std::move(coarse.x), std::move(coarse.y), reach, std::move(own)});
    rest = std::move(fine);
    x = rest.x, y = rest.y, radius = rest.radius;
  }
}

}  // namespace nscdd
