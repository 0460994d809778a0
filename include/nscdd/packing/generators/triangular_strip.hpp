// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/core/types.hpp>
#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Two rows of touching equal disks: grain i at (i r, (i mod 2) sqrt(3) r). With n grains it has 2n - 3
/// contacts and is isostatic; n = 4, 8, 12 are the examples of [ADI12] Figures 2-4.
struct TriangularStrip {
  static constexpr std::string_view name = "strip";
  static constexpr std::string_view summary = "two rows of touching equal disks, isostatic (2n-3 contacts)";
  Index grains = 4;
  double radius = 0.5;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("grains", self.grains, Field{.description = "number of disks", .minimum = 1, .maximum = 1e7});
    visit("radius", self.radius,
          Field{.description = "radius of every disk", .unit = "m", .minimum = 0, .minimum_excluded = true});
  }
};

Packing generate(const TriangularStrip& strip, const Monitor& monitor = {});

}  // namespace nscdd
