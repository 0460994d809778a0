// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/analysis.hpp"

#include <lapacke.h>

#include <atomic>
#include <cstdlib>
#include <mutex>

namespace nscdd {

using Block = Eigen::Map<Matrix, 0, Eigen::OuterStride<>>;
using ConstBlock = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;

/// Factor of a front: columns of L with D on the diagonal, panel by panel.
struct FrontFactor {
  double* columns = nullptr;      ///< rows x pivots
  std::vector<lapack_int> swaps;  ///< LAPACK's ipiv, panel by panel
  Vector off;                     ///< subdiagonal of D
};

/// Interchanges of one panel in LAPACK's order: swap(i, j) exchanges two different indices of the panel.
template <bool backwards = false>
void interchange(const lapack_int* ipiv, Index n, const auto& swap) {
  for (Index done = 0; done < n; ++done) {
    const Index k = backwards ? n - 1 - done : done;
    const bool single = ipiv[k] > 0;  // else a 2 x 2 block: its second row was exchanged
    const Index i = (single || backwards) ? k : k + 1, j = std::abs(ipiv[k]) - 1;
    if (i != j) swap(i, j);
    if (!single) ++done;
  }
}

/// Replaces b by D^-1 b, where D has this diagonal and the subdiagonal e, which is nonzero in 2 x 2 blocks.
void solve_diagonal(const auto& diagonal, const double* e, auto&& b) {
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

/// Calls visit(first pivot, width, L with D on its diagonal, L below) for the panels of a front.
template <bool backwards = false>
void for_panels(const Front& front, const FrontFactor& factor, const auto& visit) {
  for (std::size_t n = 0; n < front.panels.size(); ++n) {
    const std::size_t k = backwards ? front.panels.size() - 1 - n : n;
    const Index first = k == 0 ? 0 : front.panels[k - 1], width = front.panels[k] - first;
    const double* start = factor.columns + first * front.rows + first;
    const Eigen::OuterStride<> stride(front.rows);
    visit(first, width, ConstBlock(start, width, width, stride),
          ConstBlock(start + width, front.rows - first - width, width, stride));
  }
}

/// Multiplies the values of a front's rows, one column per right-hand side, by L^-1.
void go_forward(const Front& front, const FrontFactor& factor, auto& local) {
  for_panels(front, factor, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock& left) {
    auto head = local.middleRows(first, width);
    interchange(factor.swaps.data() + first, width, [&](Index i, Index j) { head.row(i).swap(head.row(j)); });
    diagonal.triangularView<Eigen::UnitLower>().solveInPlace(head);
    local.bottomRows(left.rows()).noalias() -= left * head;
  });
}
/// Multiplies them by L^-T D^-1.
void go_back(const Front& front, const FrontFactor& factor, auto& local) {
  for_panels<true>(front, factor, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock& left) {
    auto head = local.middleRows(first, width);
    solve_diagonal(diagonal, factor.off.data() + first, head);
    head.noalias() -= left.transpose() * local.bottomRows(left.rows());
    diagonal.triangularView<Eigen::UnitLower>().transpose().solveInPlace(head);
    interchange<true>(factor.swaps.data() + first, width, [&](Index i, Index j) { head.row(i).swap(head.row(j)); });
  });
}

/// Eliminates the pivots of a front. `factor.columns`: entries, rows x pivots, replaced by L with D on its diagonal.
/// `update`: lower triangle of the rest, replaced by the Schur complement; uninitialised and counted as zero if
/// `fresh`. Returns the number of negative pivots, nothing if one is zero.
std::optional<Index> eliminate_front(const Front& front, FrontFactor& factor, Matrix& update, bool fresh);

/// Uninitialised array; a large one in huge pages: gigabytes in pages of 4 KiB take seconds. Throws std::bad_alloc.
struct Free {
  void operator()(double* data) const { std::free(data); }
};
using LargeArray = std::unique_ptr<double[], Free>;
LargeArray large_array(Index size);

/// L D L^T of the first rows of a dense matrix, pivoted as in SymmetricFactor, and the Schur complement on the others.
class DenseFront {
 public:
  /// `lower`: its lower triangle. `group_ends`: ends of the groups of rows that are eliminated, ascending.
  DenseFront(Matrix lower, const std::vector<Index>& group_ends);

  bool regular() const { return negative_.has_value(); }            ///< false if a pivot is exactly zero
  Index negative_eigenvalues() const { return negative_.value(); }  ///< among the pivots
  Matrix take_update() { return std::move(update_); }               ///< the Schur complement, lower triangle

  /// Multiplies the values of eliminated rows by L^-1 and subtracts their contribution from the others.
  void go_forward(Vector& values) const { nscdd::go_forward(front_, factor_, values); }
  /// Solves for the eliminated rows, given the solution on the others.
  void go_back(Vector& values) const { nscdd::go_back(front_, factor_, values); }

 private:
  Front front_;
  LargeArray columns_;
  FrontFactor factor_;
  Matrix update_;
  std::optional<Index> negative_;
};

/// The eliminated fronts of the border or of the interior.
struct EliminatedFronts {
  EliminatedFronts(const FrontTree& tree, bool on_border, LargeArray memory);

  LargeArray columns;  // of all factors
  std::vector<FrontFactor> factors;
  std::vector<Matrix> updates;  // passed from a front to its parent
  std::atomic<Index> negative = 0;
  std::atomic<bool> singular = false;
};

struct InteriorFronts {
  InteriorFronts(std::shared_ptr<const FrontTree> analysis, const SparseMatrix& lower);

  std::shared_ptr<const FrontTree> tree;
  EliminatedFronts fronts;  // finally only the interior roots have updates

  // Memory of the last factor, reused: new pages are expensive.
  mutable std::mutex mutex;
  mutable LargeArray left;
};

struct FactorFronts {
  FactorFronts(std::shared_ptr<const InteriorFronts> interior_fronts, const SparseMatrix& lower, Matrix& kept_block);
  ~FactorFronts();

  std::shared_ptr<const InteriorFronts> interior;
  const FrontTree& tree;
  EliminatedFronts border;

  const FrontFactor& factor(Index s) const {
    return (tree.front(s).on_border ? border : interior->fronts).factors[at(s)];
  }
};

}  // namespace nscdd
