// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/krylov.hpp"
#include <nscdd/ddm/spectral_radius.hpp>

#include <complex>

namespace nscdd {

/// What becomes of eigenvalues within 1e-9 of 1, impulses that the networks can carry either way.
enum class UnitEigenvalues {
  none,         ///< there are none: every eigenvalue counts alike
  counted,      ///< counted, and left out of `subdominant` only
  passed_over,  ///< counted, and left out of everything
};

/// Spectral radius of a nonsymmetric iteration map.
struct MapRadius {
  double value = 0;
  std::complex<double> dominant;  ///< its eigenvalue; of a pair, the one with positive imaginary part
  Index unit_multiplicity = 0;    ///< unit eigenvalues; -1 where ARPACK did not count them
  double subdominant = 0;         ///< largest modulus among the others; NaN where ARPACK met a unit eigenvalue
  std::string_view solver = "none";
  Index applications = 0;  ///< of the map
  double residual = 0;     ///< ||J x - lambda x|| / ||x||
  bool converged = true;   ///< the residual is at most tolerance x max(1, value)
};

/// Dense eigenvalues or ARPACK's nonsymmetric driver, matrix-free, as choose_inexact_solver says. The
/// fallback is taken if ARPACK does not converge or meets a unit eigenvalue, unless these are passed over.
MapRadius map_radius(Index n, const LinearMap& map, const SpectralOptions& options, UnitEigenvalues units);
MapRadius map_radius(const Matrix& map, const SpectralOptions& options, UnitEigenvalues units);

}  // namespace nscdd
