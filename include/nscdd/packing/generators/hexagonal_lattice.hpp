// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Touching equal disks on a triangular lattice (hexagonal packing), row by row: grain k = row x columns +
/// column at ((2 column + row mod 2) r, row sqrt(3) r). Hyperstatic from 2 rows of 3 on.
struct HexagonalLattice {
  static constexpr std::string_view name = "hexagonal";
  static constexpr std::string_view summary = "touching equal disks on a triangular lattice, hyperstatic";
  Index columns = 8;
  Index rows = 8;
  double radius = 0.5;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("columns", self.columns, Field{.description = "disks per row", .minimum = 1, .maximum = 1e5});
    visit("rows", self.rows, Field{.description = "rows", .minimum = 1, .maximum = 1e5});
    visit("radius", self.radius,
          Field{.description = "radius of every disk", .unit = "m", .minimum = 0, .minimum_excluded = true});
  }
};

/// Throws Error for more than 10^7 disks.
Packing generate(const HexagonalLattice& lattice);

}  // namespace nscdd
