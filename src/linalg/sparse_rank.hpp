// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/factor.hpp"

namespace nscdd {

/// Tolerance of a rank: smaller singular values of a matrix with unit columns count as zero.
inline constexpr double rank_tolerance = 1e-6;

/// The rank of a sparse matrix A by inertia. With B the columns of A scaled to unit length, those that are zero left
/// out, the factorisation
///     [ I    B              ]
///     [ B^T  tolerance^2 I  ]  =  L D L^T
/// has as many negative eigenvalues as B^T B has eigenvalues above tolerance^2. Sparse QR without column exchanges,
/// such as SuiteSparseQR, finds too large a rank for lattices of a few thousand disks.
struct CountedRank {
  explicit CountedRank(const SparseMatrix& a, double tolerance = rank_tolerance);

  std::vector<Index> filled;  ///< the nonzero columns of A, those of B
  SparseMatrix b;
  std::optional<SymmetricAnalysis> analysis;  ///< of the saddle point, as `factor`; none if B has no columns
  std::optional<SymmetricFactor> factor;
  Index value = 0;
  /// False unless two reliable factorisations, with tolerances near the requested one, agree on the rank. The rank is
  /// then the last one counted.
  bool conclusive = true;
  /// False if B has a singular value between 0.55 and 1.8 times the tolerance.
  bool clear = true;

 private:
  bool exact_enough(const SparseMatrix& matrix) const;
};

/// The rank of a matrix, and whether it is clear (CountedRank).
struct MatrixRank {
  Index value = 0;
  bool clear = true;
};

/// Rank of a sparse matrix by such a factorisation or, if that is not conclusive, by the dense spectrum of B^T B for up
/// to 1 500 columns.
MatrixRank sparse_rank(const SparseMatrix& a, double tolerance = rank_tolerance);

}  // namespace nscdd
