// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

enum class Distribution { uniform, uniform_volume, two_sizes, lognormal };
constexpr auto names_of(Distribution) {
  return std::to_array<std::string_view>({"uniform", "uniform_volume", "two_sizes", "lognormal"});
}

/// Radii of polydisperse grains, all within [radius_min, radius_max]. Equal bounds are one size.
///
///   uniform         number density constant: r = a + u (b - a)
///   uniform_volume  every size class holds the same area of grains, number density ~ 1/r^2: 1/r = 1/a - u (1/a - 1/b)
///   two_sizes       radius_max for a fraction `fraction_large` of the grains, by number; else radius_min
///   lognormal       ln r normal of mean ln `median` and deviation `sigma`, truncated to [a, b]:
///                   r = F^-1(F(a) + u (F(b) - F(a))), F that of the untruncated law; median 0 stands for sqrt(a b)
///
/// with a = radius_min, b = radius_max and u uniform in [0, 1). A distribution ignores the parameters of others.
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
          Field{.description = "lognormal: deviation of ln radius before truncation", .above = 0, .maximum = 100});
  }
};

/// The radius of each u in [0, 1), increasing: the inverse of the distribution function, one uniform number per grain.
/// Throws Error for radius_min > radius_max, and if no lognormal radius lies between them in double precision.
std::function<double(double u)> radius_quantile(const SizeDistribution& sizes);

template <class AnyDeposit, class Visitor>
void visit_deposit(AnyDeposit& deposit, Visitor& visit) {
  visit("grains", deposit.grains, Field{.description = "number of grains", .minimum = 1, .maximum = 1e7});
  visit(
      "width", deposit.width,
      Field{.description = "width of the box, along x; 0 for a bed about as high as wide", .unit = "m", .minimum = 0});
  if constexpr (requires { deposit.depth; })
    visit("depth", deposit.depth,
          Field{.description = "depth of the box, along y; 0 for that of the width", .unit = "m", .minimum = 0});
  SizeDistribution::fields(deposit.sizes, visit);
  visit("seed", deposit.seed, Field{.description = "seed of sizes and places", .minimum = 0, .maximum = 4294967295.0});
}

/// Grains dropped one by one at random places into a box with a floor (y = 0) and two walls (x = 0, x = width). Each
/// rolls downhill over earlier grains until it rests on two supports (grains, wall) with its centre between them, or on
/// the floor (Visscher & Bolsterli, Nature 239 (1972) 504-507), and never moves again. Places of rest are closed-form
/// intersections of circles and lines: grains touch to rounding. They are numbered in the order of their fall.
///
/// Floor and walls are no grains: a grain that leans on one has fewer contacts. All others rest on two grains each, so
/// the network has at most 2 contacts per grain and is isostatic or less, except for stacks of equal sizes.
struct Deposit {
  static constexpr std::string_view name = "deposit";
  static constexpr std::string_view summary =
      "grains of random sizes dropped into a box, each rolled to rest on two supports";
  static constexpr Index dimension = 2;
  Index grains = 1000;
  double width = 0;  ///< m; 0 for a bed about as high as wide
  SizeDistribution sizes = {};
  Index seed = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit_deposit(self, visit);
  }
};

/// Deposit in space: spheres dropped into a box with a floor (z = 0) and four walls (x = 0, x = width, y = 0,
/// y = depth). Each falls, rolls over one sphere, then in the groove between two, by steepest descent, until the floor
/// or three supports (spheres, walls) hold it, with its centre above the triangle of the points of contact. Paths are
/// vertical lines and arcs, whose ends are closed-form roots. The network has at most 3 contacts per grain.
struct SphereDeposit {
  static constexpr std::string_view name = "sphere_deposit";
  static constexpr std::string_view summary =
      "spheres of random sizes dropped into a box, each rolled to rest on three supports";
  static constexpr Index dimension = 3;
  Index grains = 1000;
  double width = 0;  ///< along x, m; 0 for a bed about as high as wide
  double depth = 0;  ///< along y, m; 0 for the width
  SizeDistribution sizes = {};
  Index seed = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit_deposit(self, visit);
  }
};

/// Generate a deposit in O(N); sizes 1 : 100 in the plane cost some five times as much as equal ones. The first
/// `grains` random numbers are the sizes, the next ones the places (x, in space x and y of each drop): equal seeds give
/// equal sizes in any box. Throw Error for fields out of bounds, for sizes that radius_quantile refuses, and for a box
/// narrower than the largest grain, or wider than 10^7 radius_min (where rounding would hide which grains touch).
Packing generate(const Deposit& deposit, const Monitor& monitor = {});
Packing generate(const SphereDeposit& deposit, const Monitor& monitor = {});

}  // namespace nscdd
