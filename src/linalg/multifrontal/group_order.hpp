// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/sparse_cholesky.hpp"

namespace nscdd {

/// Marks of groups, one per group, or none at all.
struct GroupFlags {
  std::vector<char> last;  ///< to be eliminated after all others
  std::vector<char> kept;  ///< not to be eliminated
};

/// Order of the nodes marked in `last` (one flag per node) once all others are eliminated. The others form connected
/// parts, each of which ties all marked nodes that it touches. Marked nodes that touch the same parts are a segment.
/// Segments are in minimum-degree order: next is the one with the fewest rows tied to it (George, Liu, SIAM Review 31
/// (1989) 1-19), among equals the one with the shortest chain of segments below it, so that a chain of subdomains is
/// eliminated from both ends. `weight`: rows of each node. Ties between marked nodes are ignored.
std::vector<int> order_of_last(const Graph& graph, const std::vector<int>& weight, const std::vector<char>& last);

/// Orders the groups of this graph, of `weight` rows each, by nested dissection (METIS), then those that are last, then
/// those kept, and finds the supernodes of that order. The kept groups form the last supernode.
Supernodes ordered_supernodes(const Graph& graph, const std::vector<int>& weight, const GroupFlags& flags,
                              const MergedColumns& merged);

}  // namespace nscdd
