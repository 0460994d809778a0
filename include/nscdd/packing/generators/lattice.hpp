// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

inline constexpr Field radius_of_all{.description = "radius of every disk", .unit = "m", .above = 0};

/// Two rows of touching equal disks: grain i at (i r, (i mod 2) sqrt(3) r). With n grains it has 2n - 3 contacts and is
/// isostatic; n = 4, 8, 12 are the examples of [ADI12] Figures 2-4.
struct TriangularStrip {
  static constexpr std::string_view name = "strip";
  static constexpr std::string_view summary = "two rows of touching equal disks, isostatic (2n-3 contacts)";
  static constexpr Index dimension = 2;
  Index grains = 4;
  double radius = 0.5;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("grains", self.grains, Field{.description = "number of disks", .minimum = 1, .maximum = 1e7});
    visit("radius", self.radius, radius_of_all);
  }
};

/// Throws Error for parameters out of their bounds.
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
  static constexpr Index dimension = 2;
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

/// Throws Error for parameters out of their bounds and for more than 10^7 sites.
Packing generate(const HexagonalLattice& lattice, const Monitor& monitor = {});

/// Common parameters of lattices of touching equal spheres: layers of rows of columns, grain
/// (layer x rows + row) x columns + column, horizontal layers from z = 0 upwards. Vacancies and size disorder are those
/// of HexagonalLattice, drawn per site from the seed.
struct SphereSites {
  Index columns = 5;
  Index rows = 5;
  Index layers = 5;
  double radius = 0.5;
  double vacancies = 0;
  double disorder = 0;
  Index seed = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("columns", self.columns, Field{.description = "spheres per row, along x", .minimum = 1, .maximum = 1e5});
    visit("rows", self.rows, Field{.description = "rows per layer, along y", .minimum = 1, .maximum = 1e5});
    visit("layers", self.layers, Field{.description = "layers, along z", .minimum = 1, .maximum = 1e5});
    visit("radius", self.radius, Field{.description = "radius of every sphere", .unit = "m", .above = 0});
    visit_defects(self, visit, "fraction of the spheres left out");
  }
};

/// Stackings of touching equal spheres of c columns, r rows and l layers:
///
///   cubic  simple cubic: (2 column, 2 row, 2 layer) radius. Six neighbours inside, and (c-1) r l + c (r-1) l +
///          c r (l-1) contacts. Rows slide freely past each other: hypostatic.
///   fcc    face-centred cubic, in (001) layers: squares of touching spheres, each layer in the hollows of the one
///          below, at (2 column + s, 2 row + s, sqrt(2) layer) radius with s = layer mod 2. The cube axes [100] and
///          [010] are the diagonals of x and y. Twelve neighbours inside, and l ((c-1) r + c (r-1)) +
///          (l-1) (2 c - 1) (2 r - 1) contacts: hyperstatic.
///   hcp    hexagonal close-packed, in layers A B A B: triangular layers as HexagonalLattice has them, at
///          (2 column + row mod 2 + s, sqrt(3) (row + s/3), sqrt(8/3) layer) radius with s = layer mod 2. Twelve
///          neighbours inside, and l (r (c-1) + (r-1) (2 c - 1)) + (l-1) (r (2 c - 1) + c floor(r/2) +
///          (c-1) floor((r-1)/2)) contacts: hyperstatic.
enum class Stacking { cubic, fcc, hcp };
constexpr auto names_of(Stacking) { return std::to_array<std::string_view>({"cubic", "fcc", "hcp"}); }
constexpr std::string_view summary_of(Stacking stacking) {
  return stacking == Stacking::cubic ? "touching equal spheres on a simple cubic lattice, hypostatic"
         : stacking == Stacking::fcc ? "touching equal spheres, face-centred cubic in (001) layers, hyperstatic"
                                     : "touching equal spheres, close-packed layers A B A B, hyperstatic";
}
template <Stacking stacking>
struct SphereLattice {
  static constexpr std::string_view name = to_string(stacking), summary = summary_of(stacking);
  static constexpr Index dimension = 3;
  SphereSites sites = {};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    SphereSites::fields(self.sites, visit);
  }
};
using CubicLattice = SphereLattice<Stacking::cubic>;
using FccLattice = SphereLattice<Stacking::fcc>;
using HcpLattice = SphereLattice<Stacking::hcp>;

/// Throws Error for parameters out of their bounds and for more than 10^7 sites.
Packing generate(Stacking stacking, const SphereSites& sites, const Monitor& monitor = {});
template <Stacking stacking>
Packing generate(const SphereLattice<stacking>& lattice, const Monitor& monitor = {}) {
  return generate(stacking, lattice.sites, monitor);
}

}  // namespace nscdd
