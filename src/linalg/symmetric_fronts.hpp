// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "symmetric_analysis.hpp"

#include <lapacke.h>
#include <tbb/task_group.h>

#include <atomic>
#include <memory>
#include <vector>

namespace nscdd {

using Block = Eigen::Map<Matrix, 0, Eigen::OuterStride<>>;
using ConstBlock = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;

/// What stays of a front: columns of L with D on the diagonal, panel by panel.
struct FrontFactor {
  std::vector<double> columns;    ///< rows x pivots
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

/// The fronts of a factorisation, and the walks over their tree that every stage takes.
class SymmetricFactor::Implementation {
 public:
  using Analysis = SymmetricAnalysis::Implementation;

  Implementation(std::shared_ptr<const Analysis> a, const SparseMatrix& lower);
  Vector solve(const Vector& b) const;
  Matrix inverse_block(const std::vector<Index>& rows) const;
  std::vector<Index> smallest_pivots(Index wanted, Index first) const;

  std::atomic<Index> negative = 0;
  std::atomic<bool> singular = false;

 private:
  static constexpr double parallel_subtree_flops = 2e6;  // below, a task costs more than it brings

  // visit(child) for the children of a front; subtrees worth a task run in parallel.
  template <class Visit>
  void for_children(Index s, const Visit& visit) const {
    const Front& front = analysis->fronts[at(s)];
    if (front.subtree_flops < parallel_subtree_flops || front.children.size() < 2) {
      for (const Index c : front.children) visit(c);
      return;
    }
    tbb::task_group tasks;
    for (std::size_t k = 1; k < front.children.size(); ++k)
      tasks.run([&visit, c = front.children[k]] { visit(c); });
    visit(front.children[0]);
    tasks.wait();
  }
  template <class Visit>
  void up_the_tree(Index s, const Visit& visit) const {  // children before parents
    for_children(s, [&](Index c) { up_the_tree(c, visit); });
    visit(s);
  }
  template <class Visit>
  void down_the_tree(Index s, const Visit& visit) const {
    visit(s);
    for_children(s, [&](Index c) { down_the_tree(c, visit); });
  }
  template <class Visit>
  void for_roots(const Visit& visit) const {
    for (Index s = 0; s < count(analysis->fronts); ++s)
      if (analysis->fronts[at(s)].parent < 0) visit(s);
  }

  // visit(first pivot, width, L with D on its diagonal, L below) for each panel of a front, up or down.
  template <class Visit>
  void panel(Index s, std::size_t k, const Visit& visit) const {
    const Front& front = analysis->fronts[at(s)];
    const Index first = k == 0 ? 0 : front.panels[k - 1], width = front.panels[k] - first;
    const double* start = factors[at(s)].columns.data() + first * front.rows + first;
    const Eigen::OuterStride<> stride(front.rows);
    visit(first, width, ConstBlock(start, width, width, stride),
          ConstBlock(start + width, front.rows - first - width, width, stride));
  }
  template <class Visit>
  void for_panels(Index s, const Visit& visit) const {
    for (std::size_t k = 0; k < analysis->fronts[at(s)].panels.size(); ++k) panel(s, k, visit);
  }
  template <class Visit>
  void for_panels_back(Index s, const Visit& visit) const {
    for (std::size_t k = analysis->fronts[at(s)].panels.size(); k > 0; --k) panel(s, k - 1, visit);
  }

  void eliminate(Index s);
  bool factorise_panel(Block& diagonal, lapack_int n, lapack_int stride, lapack_int* swaps, double* off);
  void assemble(Index s, Block& columns, Matrix& update);
  void forward(Index s, Vector& x, std::vector<Vector>& carried) const;
  void backward(Index s, Vector& x) const;

  std::shared_ptr<const Analysis> analysis;
  const double* values;  // of the matrix, during the factorisation only
  std::vector<FrontFactor> factors;
  std::vector<Matrix> updates;
};

}  // namespace nscdd
