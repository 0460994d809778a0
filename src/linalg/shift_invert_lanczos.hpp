// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/arpack.hpp"
#include "linalg/linear_operator.hpp"
#include <nscdd/core/types.hpp>

namespace nscdd {

/// When a run of shift_invert_lanczos stops: at the first step at which every eigenvalue wanted meets one of
/// the two accuracies.
struct ShiftInvertOptions {
  Index maximum_steps = 300;  ///< Krylov vectors, cut to the size of the problem
  double tolerance = 1e-12;   ///< residual of nu = 1 / (lambda - sigma), relative to nu
  double accuracy = 0;        ///< estimated error of lambda (ShiftInvertResult::errors)
};

/// Eigenvalues of A x = lambda M x next to a shift sigma on one side of it, nearest first.
struct ShiftInvertResult {
  Vector values;   ///< Ritz values lambda, as many as wanted if there are as many on that side
  Matrix vectors;  ///< their vectors, n x k, M-orthonormal
  Vector bounds;   ///< an eigenvalue lies within this distance of each
  /// Expected distance of each from it, which is of second order: min(bound, residual^2 / gap), the gap to
  /// the next Ritz value. No proof: a gap may hide an eigenvalue that the run has not seen.
  Vector errors;
  Index applications = 0;  ///< products with (A - sigma M)^-1
  bool converged = false;  ///< all that were wanted
};

/// Shift-inverted Lanczos in the inner product of M, every vector orthogonalised against all others, without
/// restarts.
/// `solve`: x -> (A - sigma M)^-1 x; `m`: x -> M x, M symmetric positive definite. `end` = smallest looks
/// above the shift, where the smallest eigenvalues lie if none is below it; largest looks below. `start`:
/// where the iteration starts, such as the vector of a neighbouring problem; empty for a fixed vector, a
/// tenth of which is added to any other, so that the run can leave a wrong eigenvector. `locked`:
/// M-orthonormal eigenvectors to stay orthogonal to, n x l: from one start Lanczos sees one copy of a
/// multiple eigenvalue, and the others come one by one as their predecessors are locked. Equal calls give
/// equal bits. Throws Error for n < 5.
ShiftInvertResult shift_invert_lanczos(Index n, const LinearMap& solve, const LinearMap& m, double sigma,
                                       SpectrumEnd end, Index wanted, const ShiftInvertOptions& options = {},
                                       const Vector& start = {}, const Matrix& locked = {});

}  // namespace nscdd
