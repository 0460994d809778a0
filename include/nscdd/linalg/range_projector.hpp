// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <memory>
#include <vector>

namespace nscdd {

/// Orthogonal projector onto the range of a sparse matrix, by rank-revealing sparse QR (SuiteSparseQR):
/// A E = Q R, the first `rank` columns Q_1 of Q span the range, and  Pi x = Q_1 Q_1^T x.
/// Columns whose remainder falls below `tolerance` x the largest column norm of A count as dependent.
/// Any shape, rank 0 and no columns included. Q is kept as Householder vectors, never formed.
class RangeProjector {
 public:
  static constexpr double default_tolerance = 1e-8;
  explicit RangeProjector(const SparseMatrix& a, double tolerance = default_tolerance);
  Index rank() const;
  Vector apply(const Vector& x) const;  ///< Pi x, as many rows as A
  class Implementation;

 private:
  std::shared_ptr<const Implementation> implementation_;
};

/// Rank of a sparse matrix, by the same factorisation and the same tolerance.
Index sparse_rank(const SparseMatrix& a, double tolerance = RangeProjector::default_tolerance);

/// Columns of a sparse matrix that are linearly independent and span its range, ascending: those that begin a
/// new row of the R of its rank-revealing sparse QR.
std::vector<Index> independent_columns(const SparseMatrix& a,
                                       double tolerance = RangeProjector::default_tolerance);

}  // namespace nscdd
