// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/krylov.hpp"
#include "mechanics/gauss_seidel.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

namespace nscdd {

/// The two-stage iteration ([ADI12] Algorithm 1 and its enriched form) with the linear law:
///   Stage 1  (W_E + epsilon I) r_E = -v_E^d + Ahat_E^T F    exactly, or by n_GS Gauss-Seidel sweeps
///            V_E = M_E^-1 (F_E^d + H_E r_E - A_E^T F)
///   Stage 2  F <- F + omega X_eta^-1 sum_E A_E V_E
/// Stage 2 in this form is the paper's (16), with any eta and any law: its right-hand side F^d + H (r + v/eta) equals
/// M_{E,eta} V_E + A_E^T F, so X_eta F' = sum A_E V_E + X_eta F.
///
/// The state between iterations is z = (r_1, ..., r_N, F): the impulses of every subdomain, c_E each, from which its
/// sweeps start, and F_Gamma, n_Gamma. A time step starts from z = 0.
///
/// The scheme schwarz (see schwarz_contraction; `stage_one` has whole masses) runs the same Stage 1 under the sums o of
/// the resultants p of the other copies, and relaxes impulses: z = (r_1, ..., r_N, p),
///     r_E <- r_E + omega (r_E' - r_E),   p_E = N_E H_E r_E
class TwoStageIteration {
 public:
  /// `stage_one`: the decomposition with the contacts of Stage 1 (all, or the active ones); `preconditioner`: X_eta of
  /// the same gluing; `sweeps`: n_GS, or empty for an exact Stage 1. Throws Error for sweeps < 1.
  TwoStageIteration(const Decomposition& stage_one, const Law& law, InterfaceOperator preconditioner,
                    std::optional<Index> sweeps, double relaxation = 1.0,
                    DecompositionScheme scheme = DecompositionScheme::nscdd);

  /// One iteration under local loads F_E^d, one vector d n_E per subdomain. Without: the linear map J_n of errors.
  Vector iterate(Vector z, const std::vector<Vector>* loads = nullptr) const;

  Index rows() const;                                               ///< of z
  Index interface_size() const { return parts_.interface_size(); }  ///< n_Gamma
  /// schwarz: sqrt(r^T (D + epsilon) r), in which J is symmetric.
  double norm_of_impulses(const Vector& z) const;
  bool schwarz() const { return scheme_ == DecompositionScheme::schwarz; }
  bool rigid() const { return flexibility(law_) == 0; }  ///< the law is the rigid limit

 private:
  Vector stage_one(std::size_t e, const Vector& on_grains, Vector& r) const;

  Decomposition parts_;
  Law law_;
  InterfaceOperator preconditioner_;
  std::optional<Index> sweeps_;
  double relaxation_;
  DecompositionScheme scheme_;
  std::vector<ContactSystem> contacts_;
  std::vector<LinearMap> exact_;  // (W_E + epsilon I)^-1 of every subdomain; empty with sweeps
};

/// Treatment of eigenvalues within 1e-9 of 1, which are self-stresses.
enum class UnitEigenvalues {
  none,         ///< not recognised: all eigenvalues count alike
  counted,      ///< counted, and left out of `subdominant` only
  passed_over,  ///< counted, and left out of everything
};

/// Spectral radius of a nonsymmetric iteration map; it has no ends. `residual` is ||J x - lambda x|| / ||x||. Of unit
/// eigenvalues `unit_multiplicity` is -1 if ARPACK did not count them, and `subdominant` NaN if it met one.
struct MapRadius : SpectralRadius {
  std::complex<double> dominant;  ///< its eigenvalue; of a pair, the one with positive imaginary part
};

/// Dense eigenvalues or ARPACK's nonsymmetric driver, matrix-free, see choose_inexact_solver. A fallback follows if a
/// solver does not converge, or if ARPACK meets a unit eigenvalue where these are counted.
MapRadius map_radius(Index n, const LinearMap& map, const SpectralOptions& options, UnitEigenvalues units);
MapRadius map_radius(const Matrix& map, const SpectralOptions& options, UnitEigenvalues units);

/// The radius of J_n; in the rigid limit unit eigenvalues are counted. J_n is not symmetric, and its eigenvalues may be
/// complex. For the generic algorithm its nonzero spectrum is that of
///     T^n + (I - T^n) W_eps^-1 Ahat^T X^-1 Ahat,   T = -(D + L)^-1 L^T,   W_eps = D + L + L^T
/// which tends to that of B as n grows. That of schwarz is T^n + (I - T^n) (I - W_eps^-1 (W + epsilon)), W undivided.
MapRadius inexact_radius(const TwoStageIteration& iteration, const SpectralOptions& options = {});

}  // namespace nscdd
