// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/ddm/contraction.hpp>
#include <nscdd/linalg/arpack.hpp>

#include <string_view>

namespace nscdd {

enum class SpectralSolver {
  automatic,  ///< dense up to `dense_limit` interface unknowns, ARPACK above
  dense,      ///< both ends of the dense pencil (LAPACK)
  arpack,     ///< both ends by Lanczos, matrix-free (ARPACK); dense for fewer than 5 unknowns
};

struct SpectralOptions {
  SpectralSolver solver = SpectralSolver::automatic;
  Index dense_limit = 800;  ///< for `automatic`
  double tolerance = 1e-8;  ///< largest residual / max(1, rho) that counts as converged
  ArpackOptions arpack = {};
};

/// Spectral radius of a contraction operator with its certificate. Every eigenvalue of B is real, because it
/// is 1 - omega lambda for an eigenvalue lambda of the symmetric pencil (S, P).
struct SpectralRadius {
  double value = 0;  ///< rho(B) = max(|eigenvalue_min|, |eigenvalue_max|); 0 for an empty interface
  double eigenvalue_min = not_a_number;  ///< smallest eigenvalue of B (NaN for an empty interface)
  double eigenvalue_max = not_a_number;  ///< largest eigenvalue of B
  Index unit_multiplicity =
      0;  ///< of the eigenvalue 1 in the rigid limit, n_Gamma - rank X_0; 0 for epsilon > 0
  /// Largest modulus among the other eigenvalues, the rate at which the iteration converges on the
  /// complement of ker S; equals `value` where unit_multiplicity is 0, and is 0 where B = I.
  double subdominant = 0;
  double subdominant_min = not_a_number;  ///< ends of the spectrum without the unit eigenvalues
  double subdominant_max = not_a_number;
  std::string_view solver = "none";  ///< "dense", "arpack", or "none" for an empty interface
  Index applications = 0;            ///< products with interface operators; 0 where they were assembled
  /// max over both ends of ||S x - lambda P x||_{P^-1} / ||x||_P, times omega: an eigenvalue of B lies within
  /// this distance of each end given.
  double residual = 0;
  bool converged = true;  ///< the solver says so and residual <= tolerance x max(1, rho)
};

/// In the rigid limit ARPACK finds the unit eigenspace densely; with unit eigenvalues and more than 4 000
/// interface unknowns the result is not converged, with its multiplicity.
SpectralRadius spectral_radius(const Contraction& b, const SpectralOptions& options = {});

}  // namespace nscdd
