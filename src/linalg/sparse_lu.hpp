// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

struct UmfpackFactors;

/// A = L U of a sparse matrix with a symmetric pattern and a heavy diagonal (UMFPACK, symmetric strategy, AMD), for
/// many matrices of one pattern: the order of elimination is found once. Equal matrices give equal bits.
class SparseLu {
 public:
  /// `pattern`: n x n, n >= 1, compressed. Throws std::bad_alloc if UMFPACK runs out of memory.
  explicit SparseLu(const SparseMatrix& pattern);

  /// Returns false for a matrix that is singular to rounding; `solve` must not be called then.
  bool factorise(const SparseMatrix& a);
  /// A^-1 b for the matrix factorised last, without iterative refinement.
  Vector solve(const SparseMatrix& a, const Vector& b) const;
  /// Of the matrix factorised last, 1 or -1.
  int determinant_sign() const;
  /// Floating-point operations of all factorisations and solves so far, as UMFPACK counts them.
  double operations() const;

 private:
  std::shared_ptr<UmfpackFactors> factors_;
};

}  // namespace nscdd
