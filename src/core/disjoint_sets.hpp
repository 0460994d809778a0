// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <numeric>

namespace nscdd {

/// The numbers 0 ... n - 1 in sets that are joined one by one (union-find with path halving).
class DisjointSets {
 public:
  /// Every number a set of its own.
  explicit DisjointSets(Index n) : parent_(at(n)) { std::iota(parent_.begin(), parent_.end(), Index{0}); }

  /// The member that stands for the set of i, until the next join.
  Index root(Index i) {
    while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
    return i;
  }

  /// Makes the sets of i and j one; false if they were one already.
  bool join(Index i, Index j) {
    i = root(i);
    j = root(j);
    parent_[at(i)] = j;
    return i != j;
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace nscdd
