// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/generators/lattice_sites.hpp"
#include <nscdd/packing/generators/lattice.hpp>

#include <numbers>

namespace nscdd {
Packing generate(const TriangularStrip& strip, const Monitor& monitor) {
  Packing packing;
  for (Index i = 0; i < strip.grains; ++i) {
    if (i % 4096 == 0 && !report(monitor, i, strip.grains)) break;
    packing.x.push_back(static_cast<double>(i) * strip.radius);
    packing.y.push_back(i % 2 == 0 ? 0.0 : std::numbers::sqrt3 * strip.radius);
    packing.radius.push_back(strip.radius);
  }
  return packing;
}

Packing generate(const HexagonalLattice& lattice, const Monitor& monitor) {
  if (lattice.columns * lattice.rows > most_sites)
    fail("packing: expected at most {} disks, met {} columns x {} rows", most_sites, lattice.columns, lattice.rows);
  const auto add_centre = [&](Packing& packing, Index column, Index row) {
    packing.x.push_back(static_cast<double>(2 * column + row % 2) * lattice.radius);
    packing.y.push_back(static_cast<double>(row) * std::numbers::sqrt3 * lattice.radius);
  };
  return occupied_sites(lattice, lattice.rows, add_centre, monitor);
}

}  // namespace nscdd
