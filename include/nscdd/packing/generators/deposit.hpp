// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/core/monitor.hpp>
#include <nscdd/packing/packing.hpp>
#include <nscdd/packing/size_distribution.hpp>

namespace nscdd {

/// Grains dropped one by one at random places into a box with a floor (y = 0) and two walls (x = 0 and
/// x = width), each rolling downhill over those that lie there until it rests on two supports (grains, wall)
/// with its centre between them, or on the floor (Visscher & Bolsterli, Nature 239 (1972) 504-507). A placed
/// grain never moves again. Every rest is a closed-form intersection of circles and lines: touching grains
/// touch to rounding, nothing overlaps by more. Grains are numbered in the order of their fall.
///
/// Floor and walls shape the bed and are no grains: a grain that leans on one has fewer contacts. Elsewhere
/// grains rest on two others each, so that the network has at most 2 contacts per grain and is isostatic or
/// less, equal sizes stacked against each other aside.
struct Deposit {
  static constexpr std::string_view name = "deposit";
  static constexpr std::string_view summary =
      "grains of random sizes dropped into a box, each rolled to rest on two supports";
  Index grains = 1000;
  double width = 0;  ///< m; 0 for a bed about as high as wide
  SizeDistribution sizes = {};
  Index seed = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("grains", self.grains, Field{.description = "number of grains", .minimum = 1, .maximum = 1e7});
    visit("width", self.width,
          Field{.description = "width of the box; 0 for a bed about as high as wide", .unit = "m", .minimum = 0});
    SizeDistribution::fields(self.sizes, visit);
    visit("seed", self.seed, Field{.description = "seed of sizes and places", .minimum = 0, .maximum = 4294967295.0});
  }
};

/// Time proportional to the grains. Sizes far apart cost more: 1 : 100 some five times as much as equal
/// sizes, whatever the distribution. The first `grains` numbers of the stream are the sizes, the next ones
/// the places, so that equal seeds give equal sizes in boxes of any width. Throws Error for sizes that
/// radius_quantile refuses, and for a box narrower than the largest grain or wider than 10^7 radius_min
/// (where rounding would drown the tangencies).
Packing generate(const Deposit& deposit, const Monitor& monitor = {});

}  // namespace nscdd
