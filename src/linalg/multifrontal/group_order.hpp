// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/sparse_cholesky.hpp"

namespace nscdd {

/// Marks of groups, one per group, or none at all.
struct GroupFlags {
  std::vector<char> last;  ///< to be eliminated after all others
  std::vector<char> kept;  ///< not to be eliminated
};

/// Orders groups of `weight` rows each, nodes of this graph, by nested dissection (METIS), those that come last behind
/// the others and those kept behind these, and finds the supernodes of that order. With kept groups, the last one
/// contains all of them, and no other.
Supernodes ordered_supernodes(const Graph& graph, const std::vector<int>& weight, const GroupFlags& flags,
                              const MergedColumns& merged);

}  // namespace nscdd
