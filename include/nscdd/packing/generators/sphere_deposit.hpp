// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/generators/deposit.hpp>

namespace nscdd {

/// Spheres dropped one by one at random places into a box with a floor (z = 0) and four walls (x = 0, x = width, y = 0,
/// y = depth): Deposit in space. Each falls, rolls over one sphere, then in the groove between two, always by
/// steepest descent, until three (spheres, walls) hold it with its centre above the
/// triangle of the points of contact, or the floor does (Visscher & Bolsterli, Nature 239 (1972) 504-507). A placed
/// sphere never moves again. Its path consists of vertical lines and arcs of circles, whose ends are roots in closed
/// form: touching spheres touch to rounding, nothing overlaps by more. Grains are numbered in the order of their fall.
///
/// Floor and walls are no grains: a grain that leans on one has fewer contacts. All others rest on three grains each,
/// so the network has at most 3 contacts per grain and is isostatic or less.
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
    visit("grains", self.grains, Field{.description = "number of grains", .minimum = 1, .maximum = 1e7});
    visit(
        "width", self.width,
        Field{
            .description = "width of the box, along x; 0 for a bed about as high as wide", .unit = "m", .minimum = 0});
    visit("depth", self.depth,
          Field{.description = "depth of the box, along y; 0 for that of the width", .unit = "m", .minimum = 0});
    SizeDistribution::fields(self.sizes, visit);
    visit("seed", self.seed, Field{.description = "seed of sizes and places", .minimum = 0, .maximum = 4294967295.0});
  }
};

/// Generates a deposit of spheres in O(N). Sizes far apart cost more. The first `grains` numbers of the stream are the
/// sizes, the next ones the places, x and y of each drop, so that equal seeds give equal sizes in boxes of any width.
/// Throws Error for fields out of bounds, for sizes that radius_quantile refuses, and for a box narrower or less deep
/// than the largest grain, or wider or deeper than 10^7 radius_min (where rounding would drown the tangencies).
Packing generate(const SphereDeposit& deposit, const Monitor& monitor = {});

}  // namespace nscdd
