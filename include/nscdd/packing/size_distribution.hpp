// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>

#include <functional>

namespace nscdd {

enum class Distribution { uniform, uniform_volume, two_sizes, lognormal };
constexpr auto names_of(Distribution) {
  return std::to_array<std::string_view>({"uniform", "uniform_volume", "two_sizes", "lognormal"});
}

/// Radii of polydisperse grains, all within [radius_min, radius_max]. Equal bounds are one size.
///
///   uniform         number density constant: r = a + u (b - a)
///   uniform_volume  every size class holds the same area of grains (volume, in the plane), number density
///                   ~ 1/r^2: 1/r = 1/a - u (1/a - 1/b)
///   two_sizes       radius_max for a fraction `fraction_large` of the grains, by number; else radius_min
///   lognormal       ln r normal of mean ln `median` and deviation `sigma`, truncated to [a, b]:
///                   r = F^-1(F(a) + u (F(b) - F(a))) with F that of the untruncated law; median 0 stands for
///                   sqrt(a b)
///
/// with a = radius_min, b = radius_max and u uniform in [0, 1). Parameters that a distribution has no use for
/// are ignored.
struct SizeDistribution {
  Choice<Distribution> distribution = Distribution::uniform;
  double radius_min = 0.1, radius_max = 0.2;  ///< m
  double fraction_large = 0.5;
  double median = 0;  ///< m
  double sigma = 0.25;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("distribution", self.distribution,
          Field{.description = "of the radii: uniform, uniform_volume, two_sizes or lognormal"});
    visit("radius_min", self.radius_min,
          Field{.description = "smallest radius", .unit = "m", .minimum = 1e-100, .maximum = 1e100});
    visit("radius_max", self.radius_max,
          Field{.description = "largest radius", .unit = "m", .minimum = 1e-100, .maximum = 1e100});
    visit("fraction_large", self.fraction_large,
          Field{.description = "two_sizes: fraction of large grains, by number", .minimum = 0, .maximum = 1});
    visit("median", self.median,
          Field{.description = "lognormal: median before truncation; 0 for sqrt(radius_min radius_max)",
                .unit = "m",
                .minimum = 0});
    visit("sigma", self.sigma,
          Field{.description = "lognormal: deviation of ln radius before truncation",
                .minimum = 0,
                .minimum_excluded = true,
                .maximum = 100});
  }
};

/// The radius of each u in [0, 1), increasing: the inverse of the distribution function, one uniform number
/// per grain. Throws Error for radius_min > radius_max, and where no
/// lognormal radius lies between them in double precision.
std::function<double(double u)> radius_quantile(const SizeDistribution& sizes);

}  // namespace nscdd
