// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <memory>
#include <vector>

namespace nscdd {

/// Orthogonal projector onto the range of a sparse matrix A (any shape, rank 0 and no columns included). With
/// B the columns of A scaled to unit length, the sparse factorisation
///     [ I    B          ]
///     [ B^T  tolerance^2 I ]  =  L D L^T
/// has as many negative eigenvalues as B^T B has eigenvalues above tolerance^2: that is the rank, counted by
/// inertia. Pi x = x - v, where [I B; B^T 0] [v; r] = [x; 0] is solved by iterative refinement with these
/// factors. Sparse QR without column exchanges, such as SuiteSparseQR, finds too large a rank for
/// lattices of a few thousand disks.
class RangeProjector {
 public:
  /// Singular values of B below it count as zero.
  static constexpr double default_tolerance = 1e-6;

  explicit RangeProjector(const SparseMatrix& a, double tolerance = default_tolerance);
  Index rank() const;
  /// False if there were no two reliable factorisations, with tolerances near the one asked for, that agreed
  /// on the rank. The rank is then the last one counted, and `apply` gives NaN.
  bool conclusive() const;
  Vector apply(const Vector& x) const;  ///< Pi x, as many rows as A
  /// As many columns of A as its rank, ascending, that are likely to span its range: all but those with the
  /// smallest pivots.
  std::vector<Index> independent_columns() const;
  class Implementation;

 private:
  friend Index sparse_rank(const SparseMatrix& a, double tolerance);
  std::shared_ptr<const Implementation> implementation_;
};

/// Rank of a sparse matrix, by the same factorisation and tolerance. If that is not conclusive, by the dense
/// spectrum of B^T B for up to 1 500 columns.
Index sparse_rank(const SparseMatrix& a, double tolerance = RangeProjector::default_tolerance);

}  // namespace nscdd
