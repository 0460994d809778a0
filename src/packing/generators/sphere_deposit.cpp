// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/random.hpp"
#include "packing/generators/sphere_bed.hpp"

#include <numbers>

namespace nscdd {
namespace {

// A drop without an end is repeated elsewhere. None occurred among 10^7 drops of all kinds.
constexpr int most_drops = 10;

void require_bounds(const SphereDeposit& deposit) {
  SphereDeposit::fields(deposit, [](std::string_view key, const auto& value, const Field& field) {
    check_bounds(value, field, fmt::format("packing.{}", key));
  });
  const SizeDistribution& sizes = deposit.sizes;
  for (const auto& [key, size] : {std::pair("width", deposit.width), std::pair("depth", deposit.depth)})
    if (size > 0 && size < 2 * sizes.radius_max)
      fail("packing.{}: expected 0, or at least 2 radius_max = {} m, met {}", key, 2 * sizes.radius_max, size);
}

// Width and depth of the box. By default the bed is as high as wide, at the solid fraction typical of such beds.
std::pair<double, double> base_of(const SphereDeposit& deposit, const std::vector<double>& radii) {
  constexpr double solid_fraction = 0.58;
  double volume = 0;
  for (const double r : radii) volume += 4 * std::numbers::pi / 3 * r * r * r;
  const double largest = *std::max_element(radii.begin(), radii.end()), box = volume / solid_fraction;
  double width = deposit.width;
  if (width == 0) width = std::max(deposit.depth > 0 ? std::sqrt(box / deposit.depth) : std::cbrt(box), 2 * largest);
  const double depth = deposit.depth > 0 ? deposit.depth : width;
  const double most = 1e7 * deposit.sizes.radius_min;
  for (const auto& [key, size] : {std::pair("width", width), std::pair("depth", depth)})
    if (size > most) fail("packing.{}: expected at most 10^7 radius_min = {} m, met {}", key, most, size);
  return {width, depth};
}

}  // namespace

SphereBed sphere_bed(const SphereDeposit& deposit, const Monitor& monitor) {
  require_bounds(deposit);
  const auto radius_of = radius_quantile(deposit.sizes);
  RandomStream random(static_cast<std::uint64_t>(deposit.seed));
  std::vector<double> radii(at(deposit.grains));
  for (double& radius : radii) radius = radius_of(random.uniform());
  SphereBed bed;
  const auto [width, depth] = base_of(deposit, radii);
  bed.width = width;
  bed.depth = depth;
  Packing& packing = bed.packing;
  for (auto* values : {&packing.x, &packing.y, &packing.z, &packing.radius}) values->reserve(radii.size());
  SphereHeap heap(width, depth, *std::max_element(radii.begin(), radii.end()), radii);
  for (Index i = 0; i < deposit.grains; ++i) {
    if (i % 1024 == 0 && !report(monitor, i, deposit.grains)) break;
    const double radius = radii[at(i)];
    const auto place = [&](double size) {
      return std::min(radius + random.uniform() * (size - 2 * radius), size - radius);
    };
    std::optional<SphereHeap::Rest> rest;
    for (int drops = 0; !rest; ++drops) {
      if (drops == most_drops) fail("packing.seed: grain {} found no place in {} drops", i, most_drops);
      const double x = place(width), y = place(depth);
      rest = heap.settle(x, y, radius);
    }
    heap.add({rest->centre, radius});
    packing.x.push_back(rest->centre.x());
    packing.y.push_back(rest->centre.y());
    packing.z.push_back(rest->centre.z());
    packing.radius.push_back(radius);
    bed.supports.push_back(std::move(rest->supports));
  }
  bed.work = heap.work();
  return bed;
}

Packing generate(const SphereDeposit& deposit, const Monitor& monitor) {
  return std::move(sphere_bed(deposit, monitor).packing);
}

}  // namespace nscdd
