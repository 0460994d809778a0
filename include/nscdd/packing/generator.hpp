// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/generators/deposit.hpp>
#include <nscdd/packing/generators/lattice.hpp>
#include <nscdd/packing/generators/sphere_deposit.hpp>
#include <nscdd/packing/generators/sphere_lattice.hpp>

#include <variant>

namespace nscdd {

/// Every generator of packings: one file and one word here. Each has `name`, `summary`, fields and `generate`; one of
/// spheres also `static constexpr Index dimension = 3`.
using Generator =
    std::variant<TriangularStrip, HexagonalLattice, Deposit, CubicLattice, FccLattice, HcpLattice, SphereDeposit>;

/// The packing of a generator. The monitor counts grains; one that asks to stop leaves those there are.
inline Packing generate(const Generator& generator, const Monitor& monitor = {}) {
  return std::visit([&](const auto& one) { return generate(one, monitor); }, generator);
}

/// Of the packings of a generator: 2 in the plane, 3 in space.
inline Index dimension(const Generator& generator) {
  return std::visit(
      [](const auto& one) -> Index {
        if constexpr (requires { one.dimension; })
          return one.dimension;
        else
          return 2;
      },
      generator);
}

}  // namespace nscdd
