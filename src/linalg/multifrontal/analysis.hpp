// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <tbb/task_group.h>

namespace nscdd {

/// One front of the multifrontal method, a dense symmetric matrix. Its first `pivots` rows are eliminated.
struct Front {
  Index first_row = 0;  ///< of its `rows` entries in row_of
  Index rows = 0, pivots = 0;
  Index parent = -1;
  Index first_entry = 0, last_entry = 0;  ///< its entries of the matrix: first_entry ... last_entry - 1
  std::vector<Index> panels;              ///< ends of the panels of pivot columns, the last one being `pivots`
  std::vector<Index> children;            ///< ascending
  double subtree_flops = 0;               ///< of the front and all below it
  bool on_border = false;                 ///< lies on the way from a border row to the root
  Index update_rows() const { return rows - pivots; }
};

/// Cuts the pivots of a front into panels. A panel ends where a group ends.
std::vector<Index> cut_panels(const std::vector<Index>& group_ends);

/// An entry of the matrix put into a front.
struct FrontEntry {
  int source = 0;           ///< position among the stored values of the matrix
  int row = 0, column = 0;  ///< in the front, row >= column
};

/// Bytes that factors of one analysis take, from the sizes of its fronts.
struct FactorMemory {
  double held = 0;     ///< by a factor, its interior included
  double border = 0;   ///< by another factor with the same interior
  double at_once = 0;  ///< during the first factorisation at most, on as many threads as there may be
};

/// What a factor has of a front: the lower triangle, or both.
enum class FactorShape { symmetric, full };

/// The elimination tree, and walks over it in parallel over subtrees with enough work for a task.
struct FrontTree {
  Index rows = 0;                     ///< of the matrix
  std::vector<Front> fronts;          ///< children before parents
  bool keeps_rows = false;            ///< the last front, without pivots, holds rows that are not eliminated
  std::vector<int> row_of;            ///< rows of the matrix, front by front, pivots first
  std::vector<int> place_in_parent;   ///< at row_of's positions: place of an update row in the parent's rows
  std::vector<FrontEntry> entries;    ///< front by front
  std::vector<int> front_of_row;      ///< the front that eliminates a row of the matrix
  std::vector<Index> border;          ///< rows of the matrix
  std::vector<Index> interior_roots;  ///< fronts off the border whose parents, if any, are on it
  double factor_entries = 0;

  FactorMemory memory(FactorShape shape) const;
  const Front& front(Index s) const { return fronts[at(s)]; }
  Index size() const { return count(fronts); }
  const int* rows_of(const Front& front) const { return row_of.data() + front.first_row; }
  const int* places_of_updates(const Front& child) const {
    return place_in_parent.data() + child.first_row + child.pivots;
  }

  /// Calls visit(front) for all fronts of the subtree, or for those on the border only; children before parents.
  template <class Visit>
  void up(Index s, bool border_only, const Visit& visit) const {
    for_children(s, border_only, [&](Index c) { up(c, border_only, visit); });
    visit(s);
  }
  template <class Visit>
  void down(Index s, bool border_only, const Visit& visit) const {
    visit(s);
    for_children(s, border_only, [&](Index c) { down(c, border_only, visit); });
  }
  template <class Visit>
  void for_roots(bool border_only, const Visit& visit) const {
    for (Index s = 0; s < size(); ++s)
      if (front(s).parent < 0 && (!border_only || front(s).on_border)) visit(s);
  }

 private:
  static constexpr double parallel_subtree_flops = 2e6;  // below, a task costs more than it brings

  bool in_parallel(const Front& front) const {
    return front.subtree_flops >= parallel_subtree_flops && front.children.size() >= 2;
  }

  template <class Visit>
  void for_children(Index s, bool border_only, const Visit& visit) const {
    const auto one = [&](Index c) {
      if (!border_only || front(c).on_border) visit(c);
    };
    const std::vector<Index>& children = front(s).children;
    if (!in_parallel(front(s))) {
      for (const Index c : children) one(c);
      return;
    }
    tbb::task_group tasks;
    for (std::size_t k = 1; k < children.size(); ++k) tasks.run([&one, c = children[k]] { one(c); });
    one(children[0]);
    tasks.wait();
  }
};

}  // namespace nscdd
