// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>
#include <nscdd/ddm/decomposition.hpp>
#include <nscdd/spectra/spectral_radius.hpp>

namespace nscdd {

/// Where a best value was found.
enum class OptimumStatus {
  interior,         ///< at a root or an inner minimum
  eta_to_zero,      ///< the radius falls all the way down the range searched
  eta_to_infinity,  ///< with relaxation only: no enriched algorithm beats the relaxed generic one
  no_interface,     ///< nothing to optimise: one subdomain, or no shared grain
  already_exact,    ///< the generic algorithm converges in one iteration, as far as the residual tells
  all_unit,         ///< B = I: no iteration changes anything
  not_converged,    ///< some spectrum needed did not converge
};
constexpr auto names_of(OptimumStatus) {
  return std::to_array<std::string_view>(
      {"interior", "eta_to_zero", "eta_to_infinity", "no_interface", "already_exact", "all_unit", "not_converged"});
}

/// The best flexibility eta of Stage 2. With lambda_min(eta) <= lambda_max(eta) the ends of the spectrum of X_eta^-1 S
/// outside ker S, both decreasing in eta:
///   best:        lambda_min + lambda_max = 2, ends equal and opposite, rho = (lambda_max - lambda_min) / 2
///   convergent:  lambda_max < 2
///   better than the generic algorithm:  lambda_max < 1 + rho(infinity)
///   relaxed:     min over eta of (kappa - 1)/(kappa + 1), kappa = lambda_max/lambda_min,
///                reached with omega = 2/(lambda_min + lambda_max)
/// The second and third condition hold from a threshold up to infinity. Radii are subdominant: they leave out the unit
/// eigenvalues of a hyperstatic rigid limit, which no eta changes.
struct Optimum {
  OptimumStatus status = OptimumStatus::interior;
  Index unit_multiplicity = 0;
  double generic_radius = not_a_number;          ///< at eta = infinity
  double eta = not_a_number;                     ///< best eta, 1/kg
  double radius = not_a_number;                  ///< radius there
  double convergent_from = not_a_number;         ///< smallest eta with rho < 1; 0 if every eta converges
  double better_from = not_a_number;             ///< smallest eta better than the generic algorithm; 0 for all
  double generic_relaxed_radius = not_a_number;  ///< generic with its optimal omega
  double generic_relaxation = not_a_number;      ///< that omega
  OptimumStatus relaxed_status = OptimumStatus::interior;
  double relaxed_eta = not_a_number;  ///< best eta with relaxation
  double relaxed_radius = not_a_number;
  double relaxation = not_a_number;  ///< omega at relaxed_eta
  double residual = 0;               ///< largest residual of the spectra used
  Index spectra = 0;                 ///< spectra computed
  std::string failure = {};          ///< not_converged: at which eta there is no spectrum, and why
};

/// Searches 16 decades around the mean of diag(X), and two on either side of epsilon, by Brent's method on log eta.
/// S = X_epsilon of `stage_one`, which has the contacts of Stage 1 and the same gluing.
Optimum optimum(const Decomposition& parts, const Decomposition& stage_one, double epsilon,
                const SpectralOptions& options = {});

/// The eta in [1e-8, 1e8] x mean of diag(X) where the ends of X_eta^-1 S are equal and opposite about 1, to a relative
/// 1e-3, enough for a run. S = X_0 of `active`, the same gluing on fewer contacts. If the sum of the ends is at least 2
/// at the largest eta: this eta. If the radius falls down to eta = 0: that of 90 % of the gain. No interface: infinity.
double optimal_eta(const Decomposition& parts, const Decomposition& active, const SpectralOptions& options = {});

/// The eta in [1e-8, 1e8] x mean of diag(X) where omega lambda_max(X, X_eta) = 2, to a relative 1e-3; 0 if it is below
/// 2 throughout, or without an interface. From this eta up Stage 2 is stable whichever contacts open or slide: with an
/// exact Stage 1 and any set of active contacts S <= X, so omega lambda_max(S, X_eta) <= 2. Requires 0 < omega < 2.
double stable_eta(const Decomposition& parts, double relaxation = 1, const SpectralOptions& options = {});

}  // namespace nscdd
