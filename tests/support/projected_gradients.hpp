// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/krylov.hpp"
#include "mechanics/active_set.hpp"
#include <nscdd/core/types.hpp>

namespace nscdd::testing {

struct QuadraticOptions {
  double tolerance = 1e-8;             ///< on the residual, see NonnegativeMinimum
  Index maximum_iterations = 100'000;  ///< products with A
};

/// A minimum of a quadratic form over x >= 0, with what tells how good it is.
struct NonnegativeMinimum {
  Vector x;               ///< exactly 0 where the bound holds
  Vector gradient;        ///< g = A x + b, computed anew at the end
  double residual = 0;    ///< max |min(x, g)| / max |b|: the natural map, 0 at a minimum only
  Index iterations = 0;   ///< products with A
  bool converged = true;  ///< residual <= tolerance
};

/// Minimises  1/2 x^T A x + b^T x  over x >= 0, which solves the complementarity problem
///     x >= 0,   g = A x + b >= 0,   x^T g = 0
/// for A symmetric positive semidefinite, n x n, and b in its range; x and g should be of comparable size (diagonal of
/// A near 1). g is unique; if A is singular, x may not be. From the start 0, x is the solution of least norm if no
/// bound interferes. MPRGP, products with A only: conjugate gradients on the free variables, cut at the bounds, each
/// cut followed by a projected gradient step; bounds are let go once the gradient there outweighs the free one (Z.
/// Dostal, J. Schoeberl, Comput. Optim. Appl. 30 (2005) 23-43). `largest_eigenvalue`: an upper bound of that of A. A
/// run that does not converge, or that a monitor stops, is data: see `converged`.
NonnegativeMinimum minimize_nonnegative(const LinearMap& a, const Vector& b, double largest_eigenvalue, Vector start,
                                        const QuadraticOptions& options = {}, const Monitor& monitor = {});

/// The impulses of `unilateral_impulses` by `minimize_nonnegative`: products with W alone, an independent check.
UnilateralImpulses by_projected_gradients(const ReferenceProblem& problem, const QuadraticOptions& options = {},
                                          const Monitor& monitor = {});

}  // namespace nscdd::testing
