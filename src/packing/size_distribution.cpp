// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/packing/generators/deposit.hpp>

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

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
    throw Error(
        fmt::format("packing.median: expected a lognormal law with radii between radius_min = {} and "
                    "radius_max = {}, met next to none: median {}, sigma {}",
                    a, b, std::exp(zeta), sigma));
  return [=](double u) {
    const double p = low + u * (high - low);
    const double radius = upper ? gsl_cdf_lognormal_Qinv(p, zeta, sigma) : gsl_cdf_lognormal_Pinv(p, zeta, sigma);
    return std::clamp(radius, a, b);
  };
}

}  // namespace

std::function<double(double)> radius_quantile(const SizeDistribution& sizes) {
  SizeDistribution::fields(sizes, [](std::string_view key, const auto& value, const Field& field) {
    check_bounds(value, field, fmt::format("packing.{}", key));
  });
  const double a = sizes.radius_min, b = sizes.radius_max;
  if (a > b) throw Error(fmt::format("packing.radius_min: expected at most radius_max = {}, met {}", b, a));
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

}  // namespace nscdd
