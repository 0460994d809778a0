// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/ldlt/analysis.hpp"
#include "linalg/ldlt/large_array.hpp"

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

/// Replaces b by D^-1 b, where D has this diagonal and the subdiagonal e; a 2 x 2 block is where e is not 0.
template <class Diagonal, class Rows>
void solve_diagonal(const Diagonal& diagonal, const double* e, Rows&& b) {
  const Index n = diagonal.rows();
  if (b.cols() == 0) return;  // the data of an empty matrix is no place to count rows from
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

/// The walks over the elimination tree, in parallel over subtrees with enough work for a task.
class FrontTree {
 public:
  using Analysis = SymmetricAnalysis::Implementation;
  explicit FrontTree(std::shared_ptr<const Analysis> a) : analysis(std::move(a)) {}

  const Front& front(Index s) const { return analysis->fronts[at(s)]; }
  Index size() const { return count(analysis->fronts); }

  // Calls visit(front) for all fronts of the subtree, or for those on the border only; children before
  // parents.
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

  // Size of the columns of all fronts on the border, or of all others.
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

/// The eliminated fronts of the border, or those of the interior.
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
  std::vector<Matrix> updates;  // what a front hands to its parent
  std::atomic<Index> negative = 0;
  std::atomic<bool> singular = false;
};

class SymmetricInterior::Implementation {
 public:
  Implementation(std::shared_ptr<const FrontTree::Analysis> analysis, const SparseMatrix& lower);

  // Memory for a factor. That of the last factor is used again, because new pages take the system its time.
  LargeArray memory() const;
  void keep(LargeArray memory) const;

  FrontTree tree;
  EliminatedFronts fronts;  // in the end the interior roots alone have updates

 private:
  mutable std::mutex mutex_;
  mutable std::optional<LargeArray> left_;
};

class SymmetricFactor::Implementation {
 public:
  Implementation(std::shared_ptr<const SymmetricInterior::Implementation> interior_fronts, const SparseMatrix& lower);
  ~Implementation() { interior->keep(std::move(border.columns)); }
  enum class Fronts { all, border };
  // L^-1 over the fronts `forward`, which are all where b is not zero; D^-1 and L^-T over the fronts
  // `backward`.
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

  // Calls visit(first pivot, width, L with D on its diagonal, L below) for the panels of a front, up or down.
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
