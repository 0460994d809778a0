// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/krylov.hpp"

namespace nscdd {

struct IterationLimits {
  double tolerance = 1e-10;  ///< on || b - A x || / || b ||
  Index maximum = 1000;      ///< products with A
};

/// An approximate solution of A x = b. Not converged, also because a number was not finite, is data.
struct IteratedSolution {
  Vector x;
  Index iterations = 0;  ///< products with A
  double residual = 0;   ///< || b - A x || / || b ||, as the iteration has it
  bool converged = true;
  int determinant_sign = 1;  ///< of the matrix that P^-1 A is on the Krylov space; without iterations 1
};

/// Preconditioned conjugate gradients, A and P symmetric positive definite; `p_inverse`: x -> P^-1 x.
IteratedSolution conjugate_gradients(const LinearMap& a, const LinearMap& p_inverse, const Vector& b,
                                     const IterationLimits& limits = {});

/// Flexible GMRES, preconditioned from the right: the smallest || b - A x || over the preconditioned Krylov space.
/// Every vector is kept. Saad, SIAM J. Sci. Comput. 14 (1993) 461-469.
IteratedSolution generalised_minimal_residuals(const LinearMap& a, const LinearMap& p_inverse, const Vector& b,
                                               const IterationLimits& limits = {});

/// Iterations that generalised minimal residuals take on a normal matrix with these eigenvalues, where every
/// eigenvector has the same part in the right-hand side: what the eigenvalues of P^-1 A alone say. (For a symmetric
/// matrix it is also what conjugate gradients take, to within a few.) Complex ones come in pairs, side by side.
Index predicted_iterations(const Eigen::VectorXcd& eigenvalues, const IterationLimits& limits = {});

}  // namespace nscdd
