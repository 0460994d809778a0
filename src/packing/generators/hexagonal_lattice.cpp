// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/packing/generators/hexagonal_lattice.hpp>

#include <fmt/format.h>

#include <numbers>

namespace nscdd {

Packing generate(const HexagonalLattice& lattice) {
  if (lattice.columns * lattice.rows > 10'000'000)
    throw Error(fmt::format("packing: expected at most 10000000 disks, met {} columns x {} rows",
                            lattice.columns, lattice.rows));
  Packing packing;
  for (Index row = 0; row < lattice.rows; ++row)
    for (Index column = 0; column < lattice.columns; ++column) {
      packing.x.push_back(static_cast<double>(2 * column + row % 2) * lattice.radius);
      packing.y.push_back(static_cast<double>(row) * std::numbers::sqrt3 * lattice.radius);
      packing.radius.push_back(lattice.radius);
    }
  return packing;
}

}  // namespace nscdd
