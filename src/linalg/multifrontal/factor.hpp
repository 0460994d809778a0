// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/analysis.hpp"

namespace nscdd {

struct InteriorFronts;
struct FactorFronts;

/// The elimination of all apart from the border: factorisations of a family of matrices have it in common.
class SymmetricInterior {
 public:
  /// Throws Error before any work if it and a factor do not fit into memory (require_memory).
  SymmetricInterior(const SymmetricAnalysis& analysis, const SparseMatrix& lower);

 private:
  friend class SymmetricFactor;
  std::shared_ptr<const InteriorFronts> fronts_;
};

/// P A P^T = L D L^T of a sparse symmetric matrix, definite or not, D with 1 x 1 and 2 x 2 blocks (Bunch-Kaufman
/// pivoting inside panels of whole groups, LAPACK dsytrf). Fronts are factorised in parallel along the elimination
/// tree. Every sum is taken in an order fixed by the analysis, so the bits do not depend on the number of threads. By
/// Sylvester's law of inertia D has as many negative eigenvalues as the matrix whose exact factors these are. Pivots
/// are not delayed from front to front: the caller must see that this matrix is near enough to A.
class SymmetricFactor {
 public:
  /// Throws Error before any work if it does not fit into memory.
  SymmetricFactor(const SymmetricAnalysis& analysis, const SparseMatrix& lower);
  /// The same, to the last bit, of a matrix that has this interior.
  SymmetricFactor(const SymmetricInterior& interior, const SparseMatrix& lower);

  bool regular() const;                  ///< false if a pivot is exactly zero; nothing else may then be asked
  Index negative_eigenvalues() const;    ///< of A, with multiplicity
  Vector solve(const Vector& b) const;   ///< A^-1 b
  Matrix solve_columns(Matrix b) const;  ///< A^-1 B, for many columns faster than one after the other

  /// A^-1 E g, E^T A^-1 b and E^T A^-1 E g, where E scatters one value per border row. The bits are those of `solve`,
  /// with less work: paths from or to the border visit few fronts. Throws Error if the analysis has no border, or if g
  /// has another size.
  Vector solve_from_border(const Vector& g) const;
  Vector solve_to_border(const Vector& b) const;
  Vector solve_on_border(const Vector& g) const;

  /// Where rows k are kept and rows e are eliminated: the lower triangle of S = A_kk - A_ke A_ee^-1 A_ek, in the order
  /// of `kept_rows`. The inertia is then that of A_ee. A x = b is solved in steps. `go_forward` gives L^-1 b_e, and on
  /// the rows kept b_k - A_ke A_ee^-1 b_e; once S x_k = that is solved, `go_back` makes x_e of both.
  const Matrix& kept_block() const { return kept_block_; }
  Matrix take_kept_block() { return std::move(kept_block_); }
  Vector go_forward(const Vector& b, Fronts which) const;
  Vector go_back(const Vector& x, Fronts which) const;

  /// (A^-1)_{rows, rows}; visits only the fronts on the paths from these rows to the root.
  Matrix inverse_block(const std::vector<Index>& rows) const;

  /// For each row its pivot, 0 for rows of a 2 x 2 pivot.
  Vector pivots() const;

 private:
  std::shared_ptr<const FactorFronts> fronts_;
  Matrix kept_block_;
};

}  // namespace nscdd
