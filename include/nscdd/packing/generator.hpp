// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/generators/hexagonal_lattice.hpp>
#include <nscdd/packing/generators/triangular_strip.hpp>

#include <variant>

namespace nscdd {

/// Every generator of packings: one file and one word here. Each has `name`, `summary`, fields and
/// `generate`.
using Generator = std::variant<TriangularStrip, HexagonalLattice>;

inline Packing generate(const Generator& generator) {
  return std::visit([](const auto& one) { return generate(one); }, generator);
}

}  // namespace nscdd
