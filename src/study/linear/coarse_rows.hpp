// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of `nscdd coarse` by the preconditioners that need no condensed interface: those of Stage 2, and BDDC.
#pragma once

#include "linalg/linear_iteration.hpp"
#include "linalg/pencil.hpp"
#include "study/linear/coarse_table.hpp"

#include <Eigen/Cholesky>

namespace nscdd {

/// L^T P^-1 L with the eigenvalues of P^-1 S, S = L L^T; `solve`: L -> P^-1 L.
template <class Solve>
Matrix symmetric_product(const Matrix& s, const Solve& solve) {
  const Matrix lower = Eigen::LLT<Matrix>(s).matrixL();
  const Matrix product = lower.triangularView<Eigen::Lower>().transpose() * solve(lower);
  return 0.5 * (product + product.transpose());
}

/// Conjugate gradients for jumps drawn at random, and the iterations that the eigenvalues of P^-1 S predict, if any.
void solve_interface(CoarseResult& result, const LinearMap& system, const LinearMap& inverse, Index size,
                     const Vector& eigenvalues);

/// By X, or X_eta of the contacts of `network`: its spectrum is 1 minus that of the contraction.
void solve_stage_two(CoarseResult& result, const Decomposition& system, const Decomposition& network,
                     const SpectralOptions& options);

/// (M + K / epsilon) V = b, b drawn at random. Throws Error if the solution is none by our matrices.
void solve_bddc(CoarseResult& result, const Decomposition& parts, const CoarseParameters& parameters);

}  // namespace nscdd
