// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Solution of min || A x - b || of least norm, with the numerical rank of A.
struct LeastSquares {
  Vector solution;
  Index rank = 0;
};

/// Solves a dense problem of any shape and rank (LAPACK dgelsy). Pivots below `tolerance` x the largest count as zero.
LeastSquares minimum_norm_least_squares(Matrix a, const Vector& b, double tolerance = 1e-10);

/// The same solution for a sparse A, by conjugate gradients on A^T A x = A^T b from zero, preconditioned by
/// (A^T A + tau^2 I)^-1 from one sparse factorisation: it has the eigenvectors of A^T A, so that iterates stay in the
/// range of A^T. tau^2 = 1e-6 max_j ||a_j||^2: with less, rounding grows in the kernel. Returns the iterate with the
/// smallest ||A^T (b - A x)||, which may stay above 1e-13 ||A^T b||; zero if the factorisation fails.
Vector minimum_norm_least_squares(const SparseMatrix& a, const Vector& b);

}  // namespace nscdd
