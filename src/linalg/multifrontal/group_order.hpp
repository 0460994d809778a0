// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/sparse_cholesky.hpp"

namespace nscdd {

/// Marks of groups, one per group, or none at all.
struct GroupFlags {
  std::vector<char> last;  ///< to be eliminated after all others
  std::vector<char> kept;  ///< not to be eliminated
};

/// Order of the nodes marked in `last` (one flag per node) once all others are eliminated. The others fall into
/// connected parts, each of which then ties all nodes marked that it touches. Nodes that touch the same parts are one
/// segment. Segments are eliminated one after the other, always the one with the fewest rows tied to it (George, Liu,
/// SIAM Review 31 (1989) 1-19), and among equals the one with the shortest chain of segments below it: a chain of
/// subdomains is then eliminated from both ends. `weight`: rows of each node. Ties between marked nodes are ignored.
std::vector<int> order_of_last(const Graph& graph, const std::vector<int>& weight, const std::vector<char>& last);

/// Orders groups of `weight` rows each, nodes of this graph, by nested dissection (METIS), those that come last behind
/// the others and those kept behind these, and finds the supernodes of that order. With kept groups, the last one
/// contains all of them, and no other.
Supernodes ordered_supernodes(const Graph& graph, const std::vector<int>& weight, const GroupFlags& flags,
                              const MergedColumns& merged);

}  // namespace nscdd
