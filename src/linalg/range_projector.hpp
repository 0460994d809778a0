// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/factor.hpp"

namespace nscdd {

/// Factorisation of  [I B; B^T D],  D = `diagonal` I, each multiplier with the last row of B that it couples.
SymmetricFactor saddle_point_factor(const SparseMatrix& b, double diagonal);

/// Singular values of a matrix with unit columns below this count as zero.
inline constexpr double rank_tolerance = 1e-6;

/// The rank of a sparse matrix A by inertia. With B the columns of A scaled to unit length, those that are zero left
/// out, the factorisation
///     [ I    B              ]
///     [ B^T  tolerance^2 I  ]  =  L D L^T
/// has as many negative eigenvalues as B^T B has eigenvalues above tolerance^2. (Sparse QR without column exchanges,
/// such as SuiteSparseQR, finds too large a rank for lattices of a few thousand disks.)
struct CountedRank {
  explicit CountedRank(const SparseMatrix& a, double tolerance = rank_tolerance);

  std::vector<Index> filled;  ///< the nonzero columns of A, those of B
  SparseMatrix b;
  std::optional<SymmetricAnalysis> analysis;  ///< of the saddle point, as `factor`; none if B has no columns
  std::optional<SymmetricFactor> factor;
  Index value = 0;
  /// Two reliable factorisations, with tolerances near the requested one, agree on the rank; else it is the last count.
  bool conclusive = true;
  bool clear = true;  ///< false if B has a singular value between 0.55 and 1.8 times the tolerance

 private:
  bool exact_enough(const SparseMatrix& matrix) const;
};

struct MatrixRank {
  Index value = 0;
  bool clear = true;  ///< see CountedRank
};

/// Rank by CountedRank or, if that is not conclusive, by the dense spectrum of B^T B for up to 1 500 columns.
MatrixRank sparse_rank(const SparseMatrix& a, double tolerance = rank_tolerance);

/// A well-conditioned basis of the range of a matrix.
struct RangeBasis {
  std::vector<Index> columns;  ///< of the matrix, ascending
  Matrix others;               ///< rows x k, orthonormal: the rest of the range, nearly orthogonal to these columns
  bool conclusive = true;      ///< false if the range is uncertain, or its rank not clear (CountedRank)
  /// Estimated sine of the angle between the span of the basis and the space of the nonzero singular values: rounding
  /// over the smallest of these, or more if others count as zero. 0 if not measured.
  double tilt = 0;

  Index size() const { return count(columns) + others.cols(); }
};

enum class Tilt { measured, not_measured };

RangeBasis range_basis(const SparseMatrix& a, Tilt tilt = Tilt::measured);

/// Orthogonal complement of the span of independent columns: sparse ones of unit length, and orthonormal full ones.
class Complement {
 public:
  /// `factor`: of [I B; B^T t I] for any small t; made if not given.
  explicit Complement(SparseMatrix b, std::optional<SymmetricFactor> factor = {});

  bool regular() const { return factor_.regular(); }
  void leave_out(const Vector& unit);  ///< adds a unit direction orthogonal to the span
  const Matrix& others() const { return others_; }
  /// The part of x orthogonal to the span: v of [I B; B^T 0] [v; r] = [x; 0] by iterative refinement.
  Vector apply(const Vector& x) const;
  double pseudo_inverse_norm() const;  ///< 1 over the smallest singular value of B, by the power method

 private:
  SparseMatrix b_;
  SymmetricFactor factor_;
  Matrix others_;
};

/// Orthogonal projector onto the range of a sparse matrix A of any shape and rank.
class RangeProjector {
 public:
  explicit RangeProjector(const SparseMatrix& a, double tolerance = rank_tolerance, Tilt tilt = Tilt::not_measured);
  Index rank() const { return rank_; }
  /// False if the rank is not (CountedRank), or no basis could be chosen; `apply` then gives NaN.
  bool conclusive() const { return conclusive_; }
  /// Uncertainty of the range, see RangeBasis; infinity if the rank is not clear.
  double tilt() const { return tilt_; }
  Vector apply(const Vector& x) const;  ///< Pi x, as many rows as A

 private:
  Index rank_ = 0;
  bool conclusive_ = true;
  double tilt_ = 0;
  std::optional<Complement> complement_;  // none for rank 0
};

}  // namespace nscdd
