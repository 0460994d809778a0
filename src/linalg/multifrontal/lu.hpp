// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

struct LuFactors;

/// P A P^T = L U of a sparse matrix with a heavy diagonal, for many matrices of one pattern: the order of elimination
/// is found once (see README.md here). Rows are exchanged inside the pivots of a front only, so the caller should
/// refine solutions, or see how far A x is from b. The bits do not depend on the number of threads. Copies share their
/// factors; each is used from one thread at a time.
class SparseLu {
 public:
  /// `pattern`: n x n, compressed, values ignored. What it lacks of a symmetric pattern counts as zeros. Throws Error
  /// if the factors do not fit into memory (require_memory), std::bad_alloc if memory runs out.
  explicit SparseLu(const SparseMatrix& pattern);

  /// `a`: of that pattern. Returns false if a pivot is zero or not finite; `solve` must not be called then. Throws
  /// Error for another number of stored entries.
  bool factorise(const SparseMatrix& a);
  /// A^-1 b for the matrix factorised last, without iterative refinement.
  Vector solve(const Vector& b) const;
  /// Of the matrix factorised last, 1 or -1.
  int determinant_sign() const;
  /// Floating-point operations of all factorisations and solves so far, from the sizes of the fronts.
  double operations() const;
  /// Bytes that the factors and a factorisation take at most.
  double bytes_at_once() const;

 private:
  std::shared_ptr<LuFactors> factors_;
};

}  // namespace nscdd
