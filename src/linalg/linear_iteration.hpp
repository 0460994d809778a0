// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/krylov.hpp"

namespace nscdd {

struct IterationLimits {
  double tolerance = 1e-10;  ///< on || b - A x || / || b ||
  Index maximum = 1000;      ///< products with A
};

/// Approximate solution of A x = b. No convergence, or numbers that are not finite, are data.
struct IteratedSolution {
  Vector x;
  Index iterations = 0;  ///< products with A
  double residual = 0;   ///< || b - A x || / || b ||, of the iteration
  bool converged = true;
  int determinant_sign = 1;  ///< of the projection of P^-1 A on the Krylov space; 1 without iterations
};

/// Preconditioned conjugate gradients, A and P symmetric positive definite; `p_inverse`: x -> P^-1 x.
IteratedSolution conjugate_gradients(const LinearMap& a, const LinearMap& p_inverse, const Vector& b,
                                     const IterationLimits& limits = {});

/// Flexible GMRES, preconditioned from the right. Every vector is kept. Saad, SIAM J. Sci. Comput. 14 (1993) 461-469.
IteratedSolution generalised_minimal_residuals(const LinearMap& a, const LinearMap& p_inverse, const Vector& b,
                                               const IterationLimits& limits = {});

/// Predicted iterations of GMRES on a normal matrix with these eigenvalues, if all eigenvectors have the same weight in
/// the right-hand side; nearly as many as of conjugate gradients if it is symmetric. Complex pairs are adjacent.
Index predicted_iterations(const Eigen::VectorXcd& eigenvalues, const IterationLimits& limits = {});

}  // namespace nscdd
