// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Disjoint sets of the numbers 0 ... n - 1 (union-find with path halving).
class DisjointSets {
 public:
  /// Each number in its own set.
  explicit DisjointSets(Index n) : parent_(natural_order(n)) {}

  /// Representative of the set of i, until the next join.
  Index root(Index i) {
    while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
    return i;
  }

  /// Joins the sets of i and j; false if they are equal.
  bool join(Index i, Index j) {
    i = root(i);
    j = root(j);
    parent_[at(i)] = j;
    return i != j;
  }

 private:
  std::vector<Index> parent_;
};

/// The same groups, numbered in the order of appearance. Negative numbers belong to none and stay.
inline std::vector<Index> renumbered(std::vector<Index> groups) {
  std::vector<Index> number(groups.empty() ? 0 : at(std::ranges::max(groups) + 1), -1);
  Index next = 0;
  for (Index& group : groups)
    if (group >= 0) group = number[at(group)] < 0 ? number[at(group)] = next++ : number[at(group)];
  return groups;
}

}  // namespace nscdd
