// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/ldlt/large_array.hpp"
#include "linalg/ldlt/symmetric_analysis.hpp"

#include <lapacke.h>
#include <tbb/task_group.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace nscdd {

using Block = Eigen::Map<Matrix, 0, Eigen::OuterStride<>>;
using ConstBlock = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;

/// What stays of a front: columns of L with D on the diagonal, panel by panel.
struct FrontFactor {
  double* columns = nullptr;      ///< rows x pivots
  std::vector<lapack_int> swaps;  ///< LAPACK's ipiv, panel by panel
  Vector off;                     ///< subdiagonal of D
};

/// Interchanges of one panel in LAPACK's order: swap(i, j) exchanges two indices of the panel.
template <class Swap>
void interchange(const lapack_int* ipiv, Index n, Swap&& swap) {
  for (Index k = 0; k < n; ++k) {
    if (ipiv[k] > 0) {
      swap(k, ipiv[k] - 1);
    } else {  // 2 x 2 block: the second row was exchanged
      swap(k + 1, -ipiv[k] - 1);
      ++k;
    }
  }
}
template <class Swap>
void interchange_back(const lapack_int* ipiv, Index n, Swap&& swap) {
  for (Index k = n - 1; k >= 0; --k) {
    if (ipiv[k] > 0) {
      swap(k, ipiv[k] - 1);
    } else {
      swap(k, -ipiv[k] - 1);
      --k;
    }
  }
}

/// D^-1 applied to the rows of b from `first` on: d its diagonal, e its subdiagonal, 2 x 2 blocks where e is
/// set.
template <class Diagonal, class Rows>
void solve_diagonal(const Diagonal& diagonal, const double* e, Rows&& b) {
  const Index n = diagonal.rows();
  for (Index k = 0; k < n; ++k) {
    if (k + 1 < n && e[k] != 0) {
      const double a = diagonal(k, k) / e[k], c = diagonal(k + 1, k + 1) / e[k], scale = (a * c - 1) * e[k];
      for (Index j = 0; j < b.cols(); ++j) {
        const double x = b(k, j), y = b(k + 1, j);
        b(k, j) = (c * x - y) / scale;
        b(k + 1, j) = (a * y - x) / scale;
      }
      ++k;
    } else {
      b.row(k) /= diagonal(k, k);
    }
  }
}

/// The walks over the elimination tree that every stage takes; subtrees worth a task run in parallel.
class FrontTree {
 public:
  using Analysis = SymmetricAnalysis::Implementation;
  explicit FrontTree(std::shared_ptr<const Analysis> a) : analysis(std::move(a)) {}

  const Front& front(Index s) const { return analysis->fronts[at(s)]; }
  Index size() const { return count(analysis->fronts); }

  // visit(front) for those of the subtree that are on the border, or for all; children before parents.
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

  // Numbers in the columns of all fronts on the border, or of all others.
  Index entries(bool on_border) const {
    Index sum = 0;
    for (Index s = 0; s < size(); ++s)
      if (front(s).on_border == on_border) sum += front(s).rows * front(s).pivots;
    return sum;
  }

  std::shared_ptr<const Analysis> analysis;

 private:
  static constexpr double parallel_subtree_flops = 2e6;  // below, a task costs more than it brings

  template <class Visit>
  void for_children(Index s, bool border_only, const Visit& visit) const {
    const auto one = [&](Index c) {
      if (!border_only || front(c).on_border) visit(c);
    };
    const std::vector<Index>& children = front(s).children;
    if (front(s).subtree_flops < parallel_subtree_flops || children.size() < 2) {
      for (const Index c : children) one(c);
      return;
    }
    tbb::task_group tasks;
    for (std::size_t k = 1; k < children.size(); ++k) tasks.run([&one, c = children[k]] { one(c); });
    one(children[0]);
    tasks.wait();
  }
};

/// Fronts eliminated, of one side of the border or of the other.
struct EliminatedFronts {
  EliminatedFronts(const FrontTree& tree, bool on_border, LargeArray memory)
      : columns(std::move(memory)), factors(at(tree.size())), updates(at(tree.size())) {
    double* next = columns.data();
    for (Index s = 0; s < tree.size(); ++s) {
      if (tree.front(s).on_border != on_border) continue;
      factors[at(s)].columns = next;
      next += tree.front(s).rows * tree.front(s).pivots;
    }
  }
  LargeArray columns;  // of all factors
  std::vector<FrontFactor> factors;
  std::vector<Matrix> updates;  // what is left of a front for its parent
  std::atomic<Index> negative = 0;
  std::atomic<bool> singular = false;
};

class SymmetricInterior::Implementation {
 public:
  Implementation(std::shared_ptr<const FrontTree::Analysis> analysis, const SparseMatrix& lower);

  // Of a factor: what the last one that is gone has left, for the system takes its time over new pages.
  LargeArray memory() const;
  void keep(LargeArray memory) const;

  FrontTree tree;
  EliminatedFronts fronts;  // updates: of the interior roots only, once all are eliminated

 private:
  mutable std::mutex mutex_;
  mutable std::optional<LargeArray> left_;
};

class SymmetricFactor::Implementation {
 public:
  Implementation(std::shared_ptr<const SymmetricInterior::Implementation> interior_fronts,
                 const SparseMatrix& lower);
  ~Implementation() { interior->keep(std::move(border.columns)); }
  enum class Fronts { all, border };
  // L^-1 by the ones (where b is zero in the pivots of the others), D^-1 and L^-T by the others.
  Vector solve(Vector b, Fronts forward, Fronts backward) const;
  void require_border() const;              // throws Error without one
  Vector spread(const Vector& g) const;     // E g
  Vector on_border(const Vector& x) const;  // E^T x
  Matrix inverse_block(const std::vector<Index>& rows) const;
  std::vector<Index> smallest_pivots(Index wanted, Index first) const;

  std::shared_ptr<const SymmetricInterior::Implementation> interior;
  FrontTree tree;
  EliminatedFronts border;

 private:
  const FrontFactor& factor(Index s) const {
    return (tree.front(s).on_border ? border : interior->fronts).factors[at(s)];
  }

  // visit(first pivot, width, L with D on its diagonal, L below) for each panel of a front, up or down.
  template <class Visit>
  void panel(Index s, std::size_t k, const Visit& visit) const {
    const Front& front = tree.front(s);
    const Index first = k == 0 ? 0 : front.panels[k - 1], width = front.panels[k] - first;
    const double* start = factor(s).columns + first * front.rows + first;
    const Eigen::OuterStride<> stride(front.rows);
    visit(first, width, ConstBlock(start, width, width, stride),
          ConstBlock(start + width, front.rows - first - width, width, stride));
  }
  template <class Visit>
  void for_panels(Index s, const Visit& visit) const {
    for (std::size_t k = 0; k < tree.front(s).panels.size(); ++k) panel(s, k, visit);
  }
  template <class Visit>
  void for_panels_back(Index s, const Visit& visit) const {
    for (std::size_t k = tree.front(s).panels.size(); k > 0; --k) panel(s, k - 1, visit);
  }

  void go_forward(Index s, Vector& x, std::vector<Vector>& carried) const;
  void go_back(Index s, Vector& x) const;
};

}  // namespace nscdd
