// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/sparse_cholesky.hpp"

#include <tbb/task_group.h>

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

/// One front of the multifrontal method, a dense symmetric matrix. Its first `pivots` rows are eliminated.
struct Front {
  Index first_row = 0;  ///< of its `rows` entries in row_of
  Index rows = 0, pivots = 0;
  Index parent = -1;
  Index first_entry = 0, last_entry = 0;  ///< its entries of the matrix: first_entry ... last_entry - 1
  std::vector<Index> panels;              ///< ends of the panels of pivot columns, the last one is `pivots`
  std::vector<Index> children;            ///< ascending
  double subtree_flops = 0;               ///< of the front and all below it
  bool on_border = false;                 ///< on the path from a border row to the root
  Index update_rows() const { return rows - pivots; }
};

/// Cuts the pivots of a front into panels, at the ends of groups.
std::vector<Index> cut_panels(const std::vector<Index>& group_ends);

/// An entry of the matrix put into a front.
struct FrontEntry {
  int source = 0;           ///< position among the stored values of the matrix
  int row = 0, column = 0;  ///< in the front, row >= column
};

enum class Fronts {
  all,
  border,  ///< on the path from a border row to the root
};

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

  const Front& front(Index s) const { return fronts[at(s)]; }
  Index size() const { return count(fronts); }
  const int* rows_of(const Front& front) const { return row_of.data() + front.first_row; }
  const int* places_of_updates(const Front& child) const {
    return place_in_parent.data() + child.first_row + child.pivots;
  }

  /// Calls visit(front) for the fronts of the subtree, children before parents (down: after them).
  void up(Index s, Fronts which, const auto& visit) const {
    for_children(s, which, [&](Index c) { up(c, which, visit); });
    visit(s);
  }
  void down(Index s, Fronts which, const auto& visit) const {
    visit(s);
    for_children(s, which, [&](Index c) { down(c, which, visit); });
  }
  /// The same for the whole tree.
  void up(Fronts which, const auto& visit) const {
    for_roots(which, [&](Index root) { up(root, which, visit); });
  }
  void down(Fronts which, const auto& visit) const {
    for_roots(which, [&](Index root) { down(root, which, visit); });
  }

  /// Whether the subtrees of its children are separate tasks.
  bool in_parallel(const Front& front) const {
    return front.subtree_flops >= parallel_subtree_flops && front.children.size() >= 2;
  }

 private:
  static constexpr double parallel_subtree_flops = 2e6;  // below, a task costs more than it saves

  void for_roots(Fronts which, const auto& visit) const {
    for (Index s = 0; s < size(); ++s)
      if (front(s).parent < 0 && (which == Fronts::all || front(s).on_border)) visit(s);
  }
  void for_children(Index s, Fronts which, const auto& visit) const {
    const auto one = [&](Index c) {
      if (which == Fronts::all || front(c).on_border) visit(c);
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

/// Bytes that factors of one analysis take, from the sizes of its fronts.
struct FactorMemory {
  double held = 0;     ///< by a factor, its interior included
  double border = 0;   ///< by another factor with the same interior
  double at_once = 0;  ///< at most, during the first factorisation, on any number of threads
};

enum class FactorShape { symmetric, full };  ///< triangles of a front in a factor: the lower one, or both

FactorMemory factor_memory(const FrontTree& tree, FactorShape shape);

/// Work on the interior and the border of a matrix: additions and multiplications of the elimination, and entries of
/// the factor, each of which a triangular solve multiplies and adds once.
struct EliminationWork {
  double interior_flops = 0, interior_entries = 0, border_flops = 0, border_entries = 0;

  double flops(bool with_interior) const { return border_flops + (with_interior ? interior_flops : 0.0); }
  double solve_flops(Fronts up, Fronts down) const;
};

EliminationWork work_of_front(Index eliminated, Index others);  ///< the work of one dense front on the border

/// Elimination order and fronts of one pattern: nested dissection of row groups (METIS), supernodes (CHOLMOD).
class SymmetricAnalysis {
 public:
  /// `pattern`: n x n symmetric, lower triangle stored, values ignored.
  /// `group`: the number of the group of each row, 0 ... groups - 1. Rows of a group are eliminated together, so that
  /// pivots can be chosen among them: a multiplier of a saddle point belongs with the rows it ties. A row with -1 joins
  /// the last group that it touches, so that all rows it ties can be its pivot; it must touch one. Groups that are last
  /// or kept take such a row only if it touches no other.
  /// `flags`: groups that are last make `SymmetricFactor::inverse_block` on their rows cheap; only groups of the border
  /// may be kept.
  /// `border`: rows on which solutions are wanted. If the matrices of a family differ only between rows of groups of
  /// the border, fronts on no path from a border row to the root serve the whole family, see eliminated_interior.
  /// `merged`: see supernodes. Throws std::bad_alloc if the libraries run out of memory.
  SymmetricAnalysis(const SparseMatrix& pattern, const std::vector<Index>& group, const GroupFlags& flags = {},
                    const std::vector<Index>& border = {}, const MergedColumns& merged = usually_merged);

  double entries() const { return work().interior_entries + work().border_entries; }  ///< of the factor
  EliminationWork work() const;
  std::vector<Index> kept_rows() const;  ///< in the order of their groups
  const std::shared_ptr<const FrontTree>& tree() const { return tree_; }

 private:
  std::shared_ptr<const FrontTree> tree_;
};

}  // namespace nscdd
