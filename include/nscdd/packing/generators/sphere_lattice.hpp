// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/generators/lattice.hpp>

namespace nscdd {

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
    visit("radius", self.radius,
          Field{.description = "radius of every sphere", .unit = "m", .minimum = 0, .minimum_excluded = true});
    visit_defects(self, visit, "fraction of the spheres left out");
  }
};

/// Simple cubic: (2 column, 2 row, 2 layer) r. Six neighbours inside, and with c columns, r rows and l layers
/// (c-1) r l + c (r-1) l + c r (l-1) contacts. Rows slide freely past each other: hypostatic.
struct CubicLattice {
  static constexpr std::string_view name = "cubic";
  static constexpr std::string_view summary = "touching equal spheres on a simple cubic lattice, hypostatic";
  static constexpr Index dimension = 3;
  SphereSites sites = {};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    SphereSites::fields(self.sites, visit);
  }
};

/// Face-centred cubic, in (001) layers: squares of touching spheres, each layer in the hollows of the one below, at
/// (2 column + s, 2 row + s, sqrt(2) layer) r with s = layer mod 2. The cube axes [100] and [010] are the diagonals of
/// x and y. Twelve neighbours inside, and l ((c-1) r + c (r-1)) + (l-1) (2 c - 1) (2 r - 1) contacts: hyperstatic.
struct FccLattice {
  static constexpr std::string_view name = "fcc";
  static constexpr std::string_view summary = "touching equal spheres, face-centred cubic in (001) layers, hyperstatic";
  static constexpr Index dimension = 3;
  SphereSites sites = {};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    SphereSites::fields(self.sites, visit);
  }
};

/// Hexagonal close-packed, in layers A B A B: triangular layers as HexagonalLattice has them, at
/// (2 column + row mod 2 + s, sqrt(3) (row + s/3), sqrt(8/3) layer) r with s = layer mod 2. Twelve neighbours inside,
/// and l (r (c-1) + (r-1) (2 c - 1)) + (l-1) (r (2 c - 1) + c floor(r/2) + (c-1) floor((r-1)/2)) contacts: hyperstatic.
struct HcpLattice {
  static constexpr std::string_view name = "hcp";
  static constexpr std::string_view summary = "touching equal spheres, close-packed layers A B A B, hyperstatic";
  static constexpr Index dimension = 3;
  SphereSites sites = {};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    SphereSites::fields(self.sites, visit);
  }
};

/// Throw Error for more than 10^7 sites.
Packing generate(const CubicLattice& lattice, const Monitor& monitor = {});
Packing generate(const FccLattice& lattice, const Monitor& monitor = {});
Packing generate(const HcpLattice& lattice, const Monitor& monitor = {});

}  // namespace nscdd
