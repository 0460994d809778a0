// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case/case.hpp"

#include <cstdint>
#include <set>

namespace nscdd::testing {

/// A random small problem whose spectrum is likely to be degenerate: a square, hexagonal or cubic lattice with or
/// without holes, a chain, a ring, a few of these in one packing, or several copies of one of them; cut by a grid or
/// by METIS, with unit masses or masses of two sizes.
struct SmallProblem {
  Case one;
  double epsilon = 1, eta = infinity;
  Index eigenvalues = 1;
};
SmallProblem small_problem(std::uint64_t seed);

inline bool same_packing(const Packing& a, const Packing& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.radius == b.radius;
}

using Pairs = std::set<std::pair<Index, Index>>;
Pairs pairs_of(const ContactNetwork& network);

/// Grains whose gap is at most `tolerance` times the smaller radius, every pair tried: the oracle of contact detection.
Pairs touching_pairs(const Packing& packing, double tolerance);

}  // namespace nscdd::testing
