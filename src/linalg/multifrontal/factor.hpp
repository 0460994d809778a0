// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/analysis.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

#include <mutex>

namespace nscdd {

struct InteriorFronts;
struct FactorFronts;

/// The elimination of the interior, which the factorisations of a family share.
using SymmetricInterior = std::shared_ptr<const InteriorFronts>;
/// Throws Error before any work if the interior and a factor do not fit into memory (require_memory).
SymmetricInterior eliminated_interior(const SymmetricAnalysis& analysis, const SparseMatrix& lower);

/// P A P^T = L D L^T of a sparse symmetric matrix, definite or not, D with 1 x 1 and 2 x 2 blocks (Bunch-Kaufman
/// pivoting inside panels of whole groups, LAPACK dsytrf). Fronts are factorised in parallel along the elimination
/// tree, with sums in an order fixed by the analysis: the bits do not depend on the number of threads. By Sylvester's
/// law of inertia D has as many negative eigenvalues as the matrix whose exact factors these are. Pivots are not
/// delayed from front to front, so the caller must check that this matrix is near enough to A.
class SymmetricFactor {
 public:
  /// Throws Error before any work if it does not fit into memory.
  SymmetricFactor(const SymmetricAnalysis& analysis, const SparseMatrix& lower);
  /// The same bits, for a matrix with this interior, which is not null.
  SymmetricFactor(const SymmetricInterior& interior, const SparseMatrix& lower);

  bool regular() const;                  ///< false if a pivot is exactly zero; call nothing else then
  Index negative_eigenvalues() const;    ///< of A, with multiplicity
  Vector solve(const Vector& b) const;   ///< A^-1 b
  Matrix solve_columns(Matrix b) const;  ///< A^-1 B, faster than column by column

  /// A^-1 E g, E^T A^-1 b and E^T A^-1 E g, where E scatters one value per border row. The bits are those of `solve`,
  /// with less work: few fronts are on the border. Throw Error if the analysis has no border or g has another size.
  Vector solve_from_border(const Vector& g) const;
  Vector solve_to_border(const Vector& b) const;
  Vector solve_on_border(const Vector& g) const;

  /// If rows k are kept and rows e eliminated: the lower triangle of S = A_kk - A_ke A_ee^-1 A_ek, in the order of
  /// `kept_rows`. The inertia is then that of A_ee. To solve A x = b, `go_forward` gives L^-1 b_e and, on the rows
  /// kept, b_k - A_ke A_ee^-1 b_e; the caller solves S x_k = that; then `go_back` gives x_e.
  Matrix take_kept_block() { return std::move(kept_block_); }
  Vector go_forward(const Vector& b, Fronts which) const;
  Vector go_back(const Vector& x, Fronts which) const;

  /// (A^-1)_{rows, rows}, by the fronts on the paths from these rows to the root.
  Matrix inverse_block(const std::vector<Index>& rows) const;

  Vector pivots() const;  ///< the pivot of each row, 0 for rows of a 2 x 2 pivot

 private:
  std::shared_ptr<const FactorFronts> fronts_;
  Matrix kept_block_;
};

/// Analysis of a family, and the interior of its latest matrix.
class SymmetricFamily {
 public:
  explicit SymmetricFamily(SymmetricAnalysis analysis) : analysis_(std::move(analysis)) {}

  /// With equal parameters the interior is kept, see InertiaFamily.
  SymmetricFactor factorise(const SparseMatrix& lower, const std::array<double, 2>& parameters);
  bool keeps_interior(const std::array<double, 2>& parameters);  ///< for matrices with these parameters
  void release();                                                ///< frees the interior

  const SymmetricAnalysis& analysis() const { return analysis_; }

 private:
  SymmetricAnalysis analysis_;
  std::mutex mutex_;
  SymmetricInterior interior_;
  std::array<double, 2> parameters_{};
};

/// Flags of the groups with border rows only; empty if there are none.
std::vector<char> groups_of_border(const InertiaPattern& pattern);

}  // namespace nscdd
