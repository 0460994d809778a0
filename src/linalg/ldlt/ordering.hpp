// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <vector>

namespace nscdd {

/// Adjacency of row groups. The neighbours of group g, without g itself and ascending, are
/// neighbours[start[g]] ... neighbours[start[g + 1] - 1].
struct GroupGraph {
  std::vector<int> start{0}, neighbours;
};

/// Supernodes of the groups: runs of groups whose columns of the factor have the same rows below them. A
/// "position" is the place of a group in the elimination order.
struct Supernodes {
  std::vector<int> group;         ///< at each position
  std::vector<int> first_column;  ///< supernode s eliminates positions first_column[s] ... first_column[s + 1] - 1
  std::vector<int> first_row;     ///< its rows are rows[first_row[s]] ... rows[first_row[s + 1] - 1]
  std::vector<int> rows;          ///< as positions, ascending; those that s eliminates come first
  Index size() const { return static_cast<Index>(first_column.size()) - 1; }
};

/// Orders groups of `weight` rows each by nested dissection (METIS), those marked in `last` (one flag per
/// group, or none) behind all others, and finds the supernodes of that order (CHOLMOD's symbolic
/// factorisation). Throws std::bad_alloc where the libraries run out of memory.
Supernodes ordered_supernodes(const GroupGraph& graph, const std::vector<int>& weight, const std::vector<char>& last);

}  // namespace nscdd
