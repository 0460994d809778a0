// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/ddm/spectral_radius.hpp>
#include <nscdd/ddm/two_stage.hpp>

#include <complex>

namespace nscdd {

/// J_n, the map of one two-stage iteration with n Gauss-Seidel sweeps in Stage 1, on the state z = (r, F).
/// For the generic algorithm its nonzero spectrum is that of
///     T^n + (I - T^n) W_eps^-1 Ahat^T X^-1 Ahat,   T = -(D + L)^-1 L^T,   W_eps = D + L + L^T
/// and tends to that of B as n grows. Not symmetric: eigenvalues may be complex.
struct InexactIteration {
  TwoStageIteration iteration;

  Index rows() const { return iteration.contacts() + iteration.interface_size(); }
  Index cols() const { return rows(); }
  Vector apply(const Vector& z) const;  ///< one iteration of the algorithm without loads
};

/// Spectral radius of a nonsymmetric iteration map.
struct InexactRadius {
  double value = 0;
  std::complex<double>
      dominant;  ///< eigenvalue of largest modulus (of a pair, the one with positive imaginary part)
  Index unit_multiplicity =
      0;                   ///< rigid limit: eigenvalues within 1e-9 of 1; -1 where ARPACK did not count them
  double subdominant = 0;  ///< largest modulus among the others; NaN where ARPACK met a unit eigenvalue
  std::string_view solver = "none";
  Index applications = 0;  ///< iterations of the algorithm spent
  double residual = 0;     ///< ||J x - lambda x|| / ||x||
  bool converged = true;
};

/// Dense eigenvalues or ARPACK's nonsymmetric driver, matrix-free, as choose_inexact_solver says. The
/// fallback is taken where ARPACK does not converge or meets a unit eigenvalue.
InexactRadius inexact_radius(const InexactIteration& j, const SpectralOptions& options = {});

}  // namespace nscdd
