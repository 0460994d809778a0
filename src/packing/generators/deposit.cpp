// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/random.hpp"
#include "packing/drop_and_roll.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/packing/generators/deposit.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

// Width of a bed as high as wide, at the solid fraction that beds of this kind come to.
double square_width(const std::vector<double>& radii) {
  constexpr double solid_fraction = 0.8;
  const double largest = *std::max_element(radii.begin(), radii.end());
  return std::max(std::sqrt(disk_area(radii) / solid_fraction), 2 * largest);
}

}  // namespace

Packing generate(const Deposit& deposit, const Monitor& monitor) {
  const SizeDistribution& sizes = deposit.sizes;
  const auto radius_of = radius_quantile(sizes);
  if (deposit.width > 0 && deposit.width < 2 * sizes.radius_max)
    throw Error(fmt::format("packing.width: expected 0, or at least 2 radius_max = {} m, met {}", 2 * sizes.radius_max,
                            deposit.width));
  RandomStream random(static_cast<std::uint64_t>(deposit.seed));
  std::vector<double> radii(at(deposit.grains));
  for (double& radius : radii) radius = radius_of(random.uniform());
  const double width = deposit.width > 0 ? deposit.width : square_width(radii);
  if (width > 1e7 * sizes.radius_min)
    throw Error(
        fmt::format("packing.width: expected at most 10^7 radius_min = {} m, met {}", 1e7 * sizes.radius_min, width));
  Packing packing;
  packing.x.reserve(radii.size());
  packing.y.reserve(radii.size());
  packing.radius.reserve(radii.size());
  Heap heap(width, sizes.radius_max, radii);
  for (Index i = 0; i < deposit.grains; ++i) {
    if (i % 1024 == 0 && !report(monitor, i, deposit.grains)) break;
    const double radius = radii[at(i)];
    const double room = width - 2 * radius;
    const Disk disk = heap.settle(std::min(radius + random.uniform() * room, width - radius), radius);
    heap.add(disk);
    packing.x.push_back(disk.x);
    packing.y.push_back(disk.y);
    packing.radius.push_back(disk.radius);
  }
  return packing;
}

}  // namespace nscdd
