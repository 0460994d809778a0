// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/generators/deposit.hpp>
#include <nscdd/packing/generators/lattice.hpp>

namespace nscdd {

/// Generators of packings: one file and one word here each, with `name`, `summary`, `dimension`, fields and `generate`.
using Generator =
    std::variant<TriangularStrip, HexagonalLattice, Deposit, CubicLattice, FccLattice, HcpLattice, SphereDeposit>;

/// Generates a packing. The monitor counts grains; stopping keeps the grains placed so far.
inline Packing generate(const Generator& generator, const Monitor& monitor = {}) {
  return std::visit([&](const auto& one) { return generate(one, monitor); }, generator);
}

/// Dimension of a generator's packings: 2 in the plane, 3 in space.
inline Index dimension(const Generator& generator) {
  return std::visit([](const auto& one) { return one.dimension; }, generator);
}

}  // namespace nscdd
