// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

struct ConeOptions {
  double tolerance = 1e-8;  ///< on the residual, see ConeProjection
  Index maximum_iterations = 200;
};

/// The point of a polyhedral cone nearest to a given one, with its multipliers.
struct ConeProjection {
  Vector multipliers;     ///< x >= 0, one per column of B; u = point + B x
  Vector slack;           ///< s = B^T u, >= 0 within the residual
  double residual = 0;    ///< max |min(x, s)| / max |B^T point|: the natural map, 0 at the solution only
  Index iterations = 0;   ///< factorisations
  bool converged = true;  ///< residual <= tolerance
};

/// Projects a point of R^n on { u : B^T u >= 0 }, B sparse n x c without zero columns:
///     u = point + B x,   x >= 0,   s = B^T u >= 0,   x^T s = 0,
/// that is the complementarity problem of the matrix B^T B and the vector B^T point. u and s are unique; x is
/// not if columns are dependent. Primal-dual interior point method (Mehrotra), one sparse Cholesky
/// factorisation of I + B D B^T, D diagonal, per iteration. It follows the central path, so x tends to a
/// maximally complementary solution: x_i > 0 if any solution has it (O. Guler, Y. Ye, Math. Program.
/// 60 (1993) 145-162), so the set of these i does not depend on choices of the method. It ends with x_i s_i
/// <= (0.001 tolerance max |B^T point|)^2 for every i, or when rounding lets it go no further. x and s should
/// be of comparable size (unit columns). A run that does not converge, or that a monitor stops, is data: see
/// `converged`. Throws std::bad_alloc if the factor does not fit.
ConeProjection project_on_cone(const SparseMatrix& b, const Vector& point, const ConeOptions& options = {},
                               const Monitor& monitor = {});

}  // namespace nscdd
