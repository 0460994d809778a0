// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Both ends of the spectrum of a symmetric definite pencil, A x = lambda P x.
struct PencilEnds {
  bool definite = true;  ///< false where P has no Cholesky factor in double precision; the rest is then NaN
  double smallest = not_a_number;
  double largest = not_a_number;
  /// Larger ||A x - lambda P x||_{P^-1} / ||x||_P of the two eigenvectors: an eigenvalue of the pencil lies
  /// within this distance of each end given (the residual bound for symmetric pencils).
  double residual = not_a_number;
  Matrix vectors;  ///< n x 2, the eigenvectors of the two ends, x^T P x = 1
};

/// Ends of the spectrum of (A, P), A n x n symmetric, P n x n symmetric positive definite, n >= 1 (LAPACK):
/// tridiagonalisation of L^-1 A L^-T with P = L L^T, bisection and inverse iteration for the two ends only.
PencilEnds pencil_ends(const Matrix& a, const Matrix& p);

/// Orthonormal bases of the kernel of a symmetric positive semidefinite matrix and of its complement.
struct KernelSplit {
  Matrix kernel;  ///< n x m
  Matrix range;   ///< n x (n - m)
};

/// Splits R^n by a symmetric positive semidefinite matrix S of known nullity: the kernel is spanned by the
/// eigenvectors of its `nullity` smallest eigenvalues.
KernelSplit split_kernel(const Matrix& s, Index nullity);

}  // namespace nscdd
