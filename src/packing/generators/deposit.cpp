// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/random.hpp"
#include "packing/drop_and_roll.hpp"
#include <nscdd/packing/generators/deposit.hpp>

#include <gsl/gsl_cdf.h>

namespace nscdd {
namespace {

std::function<double(double)> lognormal_quantile(const SizeDistribution& sizes) {
  const double a = sizes.radius_min, b = sizes.radius_max, sigma = sizes.sigma;
  const double zeta = sizes.median > 0 ? std::log(sizes.median) : 0.5 * (std::log(a) + std::log(b));
  // In the upper tail F is 1 to rounding: there 1 - F keeps the digits.
  const bool upper = std::log(a) > zeta;
  const double low = upper ? gsl_cdf_lognormal_Q(a, zeta, sigma) : gsl_cdf_lognormal_P(a, zeta, sigma);
  const double high = upper ? gsl_cdf_lognormal_Q(b, zeta, sigma) : gsl_cdf_lognormal_P(b, zeta, sigma);
  if (a < b && !(std::abs(high - low) > 1e-300))
    fail(
        "packing.median: expected a lognormal law with radii between radius_min = {} and radius_max = {}, met next to "
        "none: median {}, sigma {}",
        a, b, std::exp(zeta), sigma);
  return [=](double u) {
    const double p = low + u * (high - low);
    const double radius = upper ? gsl_cdf_lognormal_Qinv(p, zeta, sigma) : gsl_cdf_lognormal_Pinv(p, zeta, sigma);
    return std::clamp(radius, a, b);
  };
}

// Width of a bed as high as wide, at the solid fraction typical of such beds.
double square_width(const std::vector<double>& radii) {
  constexpr double solid_fraction = 0.8;
  const double largest = *std::max_element(radii.begin(), radii.end());
  return std::max(std::sqrt(disk_area(radii) / solid_fraction), 2 * largest);
}

}  // namespace

std::function<double(double)> radius_quantile(const SizeDistribution& sizes) {
  SizeDistribution::fields(sizes, [](std::string_view key, const auto& value, const Field& field) {
    check_bounds(value, field, fmt::format("packing.{}", key));
  });
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

Packing generate(const Deposit& deposit, const Monitor& monitor) {
  const SizeDistribution& sizes = deposit.sizes;
  const auto radius_of = radius_quantile(sizes);
  if (deposit.width > 0 && deposit.width < 2 * sizes.radius_max)
    fail("packing.width: expected 0, or at least 2 radius_max = {} m, met {}", 2 * sizes.radius_max, deposit.width);
  RandomStream random(static_cast<std::uint64_t>(deposit.seed));
  std::vector<double> radii(at(deposit.grains));
  for (double& radius : radii) radius = radius_of(random.uniform());
  const double width = deposit.width > 0 ? deposit.width : square_width(radii);
  if (width > 1e7 * sizes.radius_min)
    fail("packing.width: expected at most 10^7 radius_min = {} m, met {}", 1e7 * sizes.radius_min, width);
  Packing packing;
  for (auto* values : {&packing.x, &packing.y, &packing.radius}) values->reserve(radii.size());
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
