// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/random.hpp"
#include "packing/drop_and_roll.hpp"
#include "packing/sphere_heap.hpp"
#include <nscdd/packing/generators/deposit.hpp>

#include <gsl/gsl_cdf.h>

namespace nscdd {
namespace {

// A drop that never comes to rest is repeated elsewhere; none did so among 10^7 of all kinds.
constexpr int most_drops = 10;

std::function<double(double)> lognormal_quantile(const SizeDistribution& sizes) {
  const double a = sizes.radius_min, b = sizes.radius_max, sigma = sizes.sigma;
  const double zeta = sizes.median > 0 ? std::log(sizes.median) : 0.5 * (std::log(a) + std::log(b));
  // In the upper tail F is 1 to rounding: there 1 - F keeps the digits.
  const bool upper = std::log(a) > zeta;
  const auto share = upper ? gsl_cdf_lognormal_Q : gsl_cdf_lognormal_P;
  const auto radius_at = upper ? gsl_cdf_lognormal_Qinv : gsl_cdf_lognormal_Pinv;
  const double low = share(a, zeta, sigma), high = share(b, zeta, sigma);
  if (a < b && !(std::abs(high - low) > 1e-300))
    fail(
        "packing.median: expected a lognormal law with radii between radius_min = {} and radius_max = {}, met almost "
        "none: median {}, sigma {}",
        a, b, std::exp(zeta), sigma);
  return [=](double u) { return std::clamp(radius_at(low + u * (high - low), zeta, sigma), a, b); };
}

// Keys and lengths of the sides of a box; a length of 0 is chosen by the grains.
using Sides = std::vector<std::pair<const char*, double>>;

std::vector<double> draw_radii(const auto& deposit, const Sides& sides, RandomStream& random) {
  require_bounds(deposit, "packing");
  const auto radius_of = radius_quantile(deposit.sizes);
  const double least = 2 * deposit.sizes.radius_max;
  for (const auto& [key, size] : sides)
    if (size > 0 && size < least)
      fail("packing.{}: expected 0, or at least 2 radius_max = {} m, met {}", key, least, size);
  std::vector<double> radii = random.uniforms(deposit.grains);
  for (double& radius : radii) radius = radius_of(radius);
  return radii;
}

void require_narrow(const Sides& sides, double radius_min) {
  for (const auto& [key, size] : sides)
    if (size > 1e7 * radius_min)
      fail("packing.{}: expected at most 10^7 radius_min = {} m, met {}", key, 1e7 * radius_min, size);
}

double random_place(RandomStream& random, double size, double radius) {
  return std::min(radius + random.uniform() * (size - 2 * radius), size - radius);
}

void drop_all(const std::vector<double>& radii, const Monitor& monitor, const auto& drop) {
  for (Index i = 0; i < count(radii); ++i) {
    if (i % 1024 == 0 && !report(monitor, i, count(radii))) return;
    drop(i, radii[at(i)]);
  }
}

}  // namespace

std::function<double(double)> radius_quantile(const SizeDistribution& sizes) {
  require_bounds(sizes, "packing");
  const double a = sizes.radius_min, b = sizes.radius_max;
  if (a > b) fail("packing.radius_min: expected at most radius_max = {}, met {}", b, a);
  switch (sizes.distribution) {
    case Distribution::uniform:
      return [=](double u) { return std::min(a + u * (b - a), b); };
    case Distribution::uniform_volume:
      return [=](double u) { return std::clamp(1 / (1 / a - u * (1 / a - 1 / b)), a, b); };
    case Distribution::two_sizes:
      return [a, b, small = 1 - sizes.fraction_large](double u) { return u < small ? a : b; };
    case Distribution::lognormal:
      break;
  }
  return lognormal_quantile(sizes);
}

// By default beds are as high as wide, at the solid fraction typical of them: 0.8 in the plane, 0.58 in space.
Packing generate(const Deposit& deposit, const Monitor& monitor) {
  RandomStream random(static_cast<std::uint64_t>(deposit.seed));
  const std::vector<double> radii = draw_radii(deposit, {{"width", deposit.width}}, random);
  double width = deposit.width;
  if (width == 0) width = std::max(std::sqrt(total_measure(radii, false) / 0.8), 2 * std::ranges::max(radii));
  require_narrow({{"width", width}}, deposit.sizes.radius_min);
  Packing packing;
  for (auto* values : {&packing.x, &packing.y, &packing.radius}) values->reserve(radii.size());
  Heap heap(width, deposit.sizes.radius_max, radii);
  drop_all(radii, monitor, [&](Index, double radius) {
    const Disk disk = heap.settle(random_place(random, width, radius), radius);
    heap.add(disk);
    packing.x.push_back(disk.x);
    packing.y.push_back(disk.y);
    packing.radius.push_back(disk.radius);
  });
  return packing;
}

SphereBed sphere_bed(const SphereDeposit& deposit, const Monitor& monitor) {
  RandomStream random(static_cast<std::uint64_t>(deposit.seed));
  const std::vector<double> radii = draw_radii(deposit, {{"width", deposit.width}, {"depth", deposit.depth}}, random);
  const double largest = std::ranges::max(radii), box = total_measure(radii, true) / 0.58;
  SphereBed bed{.packing = {}, .width = deposit.width, .depth = deposit.depth, .supports = {}, .work = {}};
  if (bed.width == 0) bed.width = std::max(bed.depth > 0 ? std::sqrt(box / bed.depth) : std::cbrt(box), 2 * largest);
  if (bed.depth == 0) bed.depth = bed.width;
  require_narrow({{"width", bed.width}, {"depth", bed.depth}}, deposit.sizes.radius_min);
  Packing& packing = bed.packing;
  for (auto* values : {&packing.x, &packing.y, &packing.z, &packing.radius}) values->reserve(radii.size());
  SphereHeap heap(bed.width, bed.depth, largest, radii);
  drop_all(radii, monitor, [&](Index grain, double radius) {
    std::optional<SphereHeap::Rest> rest;
    for (int drops = 0; !rest; ++drops) {
      if (drops == most_drops) fail("packing.seed: grain {} found no place in {} drops", grain, most_drops);
      const double x = random_place(random, bed.width, radius), y = random_place(random, bed.depth, radius);
      rest = heap.settle(x, y, radius);
    }
    heap.add({rest->centre, radius});
    packing.x.push_back(rest->centre.x());
    packing.y.push_back(rest->centre.y());
    packing.z.push_back(rest->centre.z());
    packing.radius.push_back(radius);
    bed.supports.push_back(std::move(rest->supports));
  });
  bed.work = heap.work();
  return bed;
}

Packing generate(const SphereDeposit& deposit, const Monitor& monitor) {
  return std::move(sphere_bed(deposit, monitor).packing);
}

}  // namespace nscdd
