// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/factor.hpp"

namespace nscdd {

/// The rank of a matrix, and whether it is clear (RangeProjector::clear).
struct MatrixRank {
  Index value = 0;
  bool clear = true;
};

/// A well-conditioned basis of the range of a matrix.
struct RangeBasis {
  std::vector<Index> columns;  ///< of the matrix, ascending
  Matrix others;               ///< rows x k, orthonormal: what the range has that these columns have next to nothing of
  bool conclusive = true;      ///< false if the range is not sure, or not clear (RangeProjector::clear)

  Index size() const { return count(columns) + others.cols(); }
};

/// Orthogonal projector onto the range of a sparse matrix A (any shape, rank 0 and no columns included). With B the
/// columns of A scaled to unit length, the sparse factorisation
///     [ I    B          ]
///     [ B^T  tolerance^2 I ]  =  L D L^T
/// has as many negative eigenvalues as B^T B has eigenvalues above tolerance^2: that is the rank, counted by inertia.
/// Pi x = x - v, where [I B; B^T 0] [v; r] = [x; 0] is solved by iterative refinement with these factors. Sparse QR
/// without column exchanges, such as SuiteSparseQR, finds too large a rank for lattices of a few thousand disks.
class RangeProjector {
 public:
  /// Singular values of B below it count as zero.
  static constexpr double default_tolerance = 1e-6;

  explicit RangeProjector(const SparseMatrix& a, double tolerance = default_tolerance);
  Index rank() const { return rank_; }
  /// False if there were no two reliable factorisations, with tolerances near the one asked for, that agreed on the
  /// rank. The rank is then the last one counted, and `apply` gives NaN.
  bool conclusive() const { return conclusive_; }
  /// False if B has a singular value between 0.3 and 3.3 times the tolerance. The range then is known no better than
  /// that.
  bool clear() const { return clear_; }
  Vector apply(const Vector& x) const;  ///< Pi x, as many rows as A
  RangeBasis basis() const;

 private:
  friend MatrixRank sparse_rank(const SparseMatrix& a, double tolerance);
  bool exact_enough(const SparseMatrix& matrix) const;

  Index rows_;
  std::vector<Index> filled_;  // columns of A that B has
  SparseMatrix b_;
  std::optional<SymmetricAnalysis> analysis_;
  std::optional<SymmetricFactor> factor_;
  Index rank_ = 0;
  bool conclusive_ = true, clear_ = true;
};

/// Rank by the same factorisation. If that is not conclusive, by the dense spectrum of B^T B for up to 1 500 columns.
MatrixRank sparse_rank(const SparseMatrix& a, double tolerance = RangeProjector::default_tolerance);

/// Solution of min || A x - b || of least norm, with the numerical rank of A.
struct LeastSquares {
  Vector solution;
  Index rank = 0;
};

/// Dense, of any shape and rank, by LAPACK dgelsy. Pivots below `tolerance` x the largest count as zero.
LeastSquares minimum_norm_least_squares(Matrix a, const Vector& b, double tolerance = 1e-10);

/// The same solution for a sparse A, by conjugate gradients on A^T A x = A^T b from zero, preconditioned by
/// (A^T A + tau^2 I)^-1 from one sparse factorisation: this shares the eigenvectors of A^T A, so that the iterates
/// stay in the range of A^T, where the solution of least norm is. tau^2 = 1e-6 max_j ||a_j||^2: smaller ones let more
/// rounding into the kernel. The iterate with the smallest ||A^T (b - A x)|| is taken; it may stay above
/// 1e-13 ||A^T b||. Zero if the factorisation fails.
Vector minimum_norm_least_squares(const SparseMatrix& a, const Vector& b);

}  // namespace nscdd
