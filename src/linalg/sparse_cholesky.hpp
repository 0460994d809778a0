// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <memory>

namespace nscdd {

struct CholmodFactor;

/// Ordering and fill pattern of the Cholesky factor of one sparsity pattern (CHOLMOD), computed once and used for
/// every matrix of that pattern. Throws std::bad_alloc if CHOLMOD runs out of memory.
class CholeskyAnalysis {
 public:
  /// `pattern`: n x n symmetric, lower triangle read, values ignored.
  explicit CholeskyAnalysis(const SparseMatrix& pattern);

 private:
  friend class SparseCholesky;
  std::shared_ptr<const CholmodFactor> symbolic_;
};

/// A = L L^T (up to a fill-reducing permutation) of a sparse symmetric positive definite matrix. A matrix that is not
/// numerically positive definite is not an error: `positive_definite()` is false and `solve` must not be called.
/// Solving is safe from one thread at a time.
class SparseCholesky {
 public:
  SparseCholesky(const CholeskyAnalysis& analysis, const SparseMatrix& a);
  bool positive_definite() const { return positive_definite_; }
  Matrix solve(const Matrix& b) const;  ///< A^-1 b, n x k

 private:
  std::shared_ptr<CholmodFactor> numeric_;
  bool positive_definite_;
};

}  // namespace nscdd
