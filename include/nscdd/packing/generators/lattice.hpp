// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// The radius field of lattices of disks.
inline constexpr Field radius_of_all{
    .description = "radius of every disk", .unit = "m", .minimum = 0, .minimum_excluded = true};

/// Two rows of touching equal disks: grain i at (i r, (i mod 2) sqrt(3) r). With n grains it has 2n - 3 contacts and is
/// isostatic; n = 4, 8, 12 are the examples of [ADI12] Figures 2-4.
struct TriangularStrip {
  static constexpr std::string_view name = "strip";
  static constexpr std::string_view summary = "two rows of touching equal disks, isostatic (2n-3 contacts)";
  Index grains = 4;
  double radius = 0.5;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("grains", self.grains, Field{.description = "number of disks", .minimum = 1, .maximum = 1e7});
    visit("radius", self.radius, radius_of_all);
  }
};

Packing generate(const TriangularStrip& strip, const Monitor& monitor = {});

/// The fields of a lattice with defects, see HexagonalLattice.
template <class Lattice, class Visitor>
void visit_defects(Lattice& lattice, Visitor& visit, std::string_view vacancies) {
  visit("vacancies", lattice.vacancies, Field{.description = vacancies, .minimum = 0, .maximum = 0.99});
  visit("disorder", lattice.disorder,
        Field{.description = "radii shrunk by factors in [1 - disorder, 1]; contacts.tolerance to match",
              .minimum = 0,
              .maximum = 0.99});
  visit("seed", lattice.seed,
        Field{.description = "seed of vacancies and disorder", .minimum = 0, .maximum = 4294967295.0});
}

/// Touching equal disks on a triangular lattice, row by row: grain k = row x columns + column at
/// ((2 column + row mod 2) r, row sqrt(3) r). Hyperstatic from 2 rows of 3 on.
///
/// Two independent defects, drawn per site from the seed:
/// - vacancies: round(vacancies x sites) disks are left out, but never the last. Vacancies are nested from fraction to
///   fraction.
/// - size disorder: radius_i = radius x (1 - disorder x u_i), u_i uniform in [0, 1). Centres stay, so neighbours
///   separate by up to 2 disorder x radius: the default contact tolerance leaves hardly any contact. A
///   contacts.tolerance >= 2 disorder / (1 - disorder) keeps every link, a smaller one thins the network at random.
struct HexagonalLattice {
  static constexpr std::string_view name = "hexagonal";
  static constexpr std::string_view summary = "touching equal disks on a triangular lattice, hyperstatic";
  Index columns = 8;
  Index rows = 8;
  double radius = 0.5;
  double vacancies = 0;
  double disorder = 0;
  Index seed = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("columns", self.columns, Field{.description = "disks per row", .minimum = 1, .maximum = 1e5});
    visit("rows", self.rows, Field{.description = "rows", .minimum = 1, .maximum = 1e5});
    visit("radius", self.radius, radius_of_all);
    visit_defects(self, visit, "fraction of the disks left out");
  }
};

/// Throws Error for more than 10^7 sites.
Packing generate(const HexagonalLattice& lattice, const Monitor& monitor = {});

}  // namespace nscdd
