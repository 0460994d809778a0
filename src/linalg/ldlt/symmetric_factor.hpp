// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <memory>
#include <vector>

namespace nscdd {

/// Elimination order and fronts of the multifrontal factorisation of one sparsity pattern, made once and used
/// for every matrix of that pattern: nested dissection (METIS) of the graph of row groups, supernodes of the
/// groups (CHOLMOD).
class SymmetricAnalysis {
 public:
  /// `pattern`: n x n symmetric, lower triangle stored, values ignored.
  /// `group`: for each row the number of its group, 0 ... groups - 1. Rows of a group are eliminated
  /// together, so that pivots can be chosen among them: a multiplier of a saddle point belongs with what it
  /// ties. -1 puts a row with the last of the groups that it touches, one at least, by when all that it ties
  /// can serve as its pivot. `last`: groups to be eliminated after all others (flags, one per group; may be
  /// empty), which makes `SymmetricFactor::inverse_block` on their rows cheap. `border`: rows whose
  /// groups alone the matrices of a family differ in (entries between two rows of such groups), and on which
  /// solutions are wanted: the fronts that are on the way from none of them to the root then serve the whole
  /// family, see SymmetricInterior. Throws std::bad_alloc where the libraries run out of memory.
  SymmetricAnalysis(const SparseMatrix& pattern, const std::vector<Index>& group,
                    const std::vector<char>& last = {}, const std::vector<Index>& border = {});

  Index rows() const;
  double entries() const;           ///< entries of the factor
  double interior_updates() const;  ///< entries that a `SymmetricInterior` keeps beside those of the factor
  double flops() const;             ///< multiplications and additions of one factorisation
  class Implementation;

 private:
  friend class SymmetricInterior;
  std::shared_ptr<const Implementation> implementation_;
};

/// The elimination of all that is apart from the border rows of an analysis: what factorisations have in
/// common of matrices that differ only between rows of the groups of the border.
class SymmetricInterior {
 public:
  SymmetricInterior(const SymmetricAnalysis& analysis, const SparseMatrix& lower);
  class Implementation;

 private:
  friend class SymmetricFactor;
  std::shared_ptr<const Implementation> implementation_;
};

/// P A P^T = L D L^T of a sparse symmetric matrix, definite or not, D with 1 x 1 and 2 x 2 blocks
/// (Bunch-Kaufman pivoting inside panels of whole groups, LAPACK dsytrf). Fronts are factorised in parallel
/// along the elimination tree; every sum is taken in an order fixed by the analysis, so the bits do not
/// depend on the number of threads.
///
/// By Sylvester's law of inertia D has as many negative eigenvalues as A; more exactly, as the matrix whose
/// factors these are. Pivots are not delayed from front to front, so that matrix should be seen to be near
/// enough.
class SymmetricFactor {
 public:
  SymmetricFactor(const SymmetricAnalysis& analysis, const SparseMatrix& lower);
  /// The same, to the last bit, of a matrix that has the interior given.
  SymmetricFactor(const SymmetricInterior& interior, const SparseMatrix& lower);

  bool regular() const;  ///< false where a pivot is exactly zero; nothing else may then be asked
  Index negative_eigenvalues() const;   ///< of A, with multiplicity
  Vector solve(const Vector& b) const;  ///< A^-1 b

  /// A^-1 E g, E^T A^-1 b and E^T A^-1 E g, where E puts what is given on the border rows in its place among
  /// zeros: the bits of `solve`, with less work. What is from or to the border passes the fronts on the way
  /// from it to the root only. They need the `border` of the analysis: Error where it was given none, and
  /// where g has not one value for each of its rows, in their order.
  Vector solve_from_border(const Vector& g) const;
  Vector solve_to_border(const Vector& b) const;
  Vector solve_on_border(const Vector& g) const;

  /// (A^-1)_{rows, rows}, by the fronts on the way from these rows to the root only.
  Matrix inverse_block(const std::vector<Index>& rows) const;

  /// Of the rows from `first` on that are pivots by themselves, the `wanted` (or as many as there are) of the
  /// smallest modulus, ascending.
  std::vector<Index> smallest_pivots(Index wanted, Index first) const;

  class Implementation;

 private:
  std::shared_ptr<const Implementation> implementation_;
};

/// b - A x for a symmetric matrix given by its lower triangle.
Vector symmetric_residual(const SparseMatrix& lower, const Vector& x, const Vector& b);

/// max_i |b - A x|_i / (|A| |x| + |b|)_i for a symmetric matrix given by its lower triangle: the smallest
/// relative change of the data of which x is the exact solution (Oettli and Prager).
double backward_error(const SparseMatrix& lower, const Vector& x, const Vector& b);

}  // namespace nscdd
