// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Eigenvalues of a symmetric definite pencil, A x = lambda P x.
struct PencilSpectrum {
  bool definite = true;  ///< false where P has no Cholesky factor in double precision; the rest is then empty
  Vector eigenvalues;    ///< all of them, ascending
  /// Largest ||A x - lambda P x||_{P^-1} / ||x||_P over the eigenvectors of the two ends: an eigenvalue of
  /// the pencil lies within this distance of each end printed (the residual bound for symmetric pencils).
  double residual = 0;
};

/// All eigenvalues of (A, P), A n x n symmetric, P n x n symmetric positive definite, n >= 0.
/// Householder tridiagonalisation of L^-1 A L^-T with P = L L^T; vectors are computed for the two ends only.
PencilSpectrum symmetric_pencil(const Matrix& a, const Matrix& p);

/// Orthonormal bases of the kernel of a symmetric positive semidefinite matrix and of its complement.
struct KernelSplit {
  Matrix kernel;  ///< n x m
  Matrix range;   ///< n x (n - m)
};

/// Splits R^n by the eigenvalues of D^-1/2 S D^-1/2, D = diag(scale) > 0: those at most `tolerance` are null.
/// The bases returned are of ker S and of its orthogonal complement, for S itself.
KernelSplit split_kernel(const Matrix& s, const Vector& scale, double tolerance = 1e-10);

}  // namespace nscdd
