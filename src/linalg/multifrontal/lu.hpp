// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

struct LuFactors;

/// P A P^T = L U of sparse matrices with a heavy diagonal and one pattern, analysed once (see README.md here). Rows are
/// exchanged only inside the pivots of a front, so the caller should refine solutions, or check b - A x. The bits do
/// not depend on the number of threads. Copies share their factors, to be used from one thread at a time.
class SparseLu {
 public:
  /// `pattern`: n x n, compressed, made symmetric by zeros. Throws Error (require_memory) or std::bad_alloc.
  explicit SparseLu(const SparseMatrix& pattern);

  /// `a`: of that pattern, else throws Error. Returns false if a pivot is zero or not finite; do not `solve` then.
  bool factorise(const SparseMatrix& a);
  Vector solve(const Vector& b) const;  ///< A^-1 b for the matrix factorised last, without iterative refinement
  int determinant_sign() const;         ///< of the matrix factorised last, 1 or -1
  /// Floating-point operations of all factorisations and solves so far, from the sizes of the fronts.
  double operations() const;
  double bytes_at_once() const;  ///< bytes that the factors and a factorisation take at most

 private:
  std::shared_ptr<LuFactors> factors_;
};

}  // namespace nscdd
