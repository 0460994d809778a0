// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/spectrum_ends.hpp"
#include "linalg/arpack.hpp"
#include "linalg/threads.hpp"

namespace nscdd {

void set_ends(SpectralRadius& result, double mu_min, double mu_max, Index unit_multiplicity) {
  result.subdominant_min = mu_min;
  result.subdominant_max = mu_max;
  result.subdominant = std::max(std::abs(mu_min), std::abs(mu_max));
  result.unit_multiplicity = unit_multiplicity;
  const bool unit = unit_multiplicity > 0;  // an eigenvalue 1 of B stays 1 whatever omega
  result.eigenvalue_min = unit ? std::min(mu_min, 1.0) : mu_min;
  result.eigenvalue_max = unit ? std::max(mu_max, 1.0) : mu_max;
  result.value = std::max(std::abs(result.eigenvalue_min), std::abs(result.eigenvalue_max));
}

SpectralRadius not_converged(std::string_view solver) {
  SpectralRadius failed;
  failed.value = failed.subdominant = failed.residual = not_a_number;
  failed.solver = solver;
  failed.converged = false;
  return failed;
}

SpectralRadius all_unit(Index size, std::string_view solver) {
  SpectralRadius result;
  result.solver = solver;
  result.value = result.eigenvalue_min = result.eigenvalue_max = 1.0;
  result.unit_multiplicity = size;
  return result;
}

SpectralRadius relaxed(const SpectralRadius& plain, double omega, double tolerance) {
  if (omega == 1.0 || plain.solver == "none" || std::isnan(plain.subdominant_min)) return plain;
  const auto shift = [omega](double mu) { return 1.0 - omega * (1.0 - mu); };
  SpectralRadius result = plain;
  set_ends(result, shift(plain.subdominant_min), shift(plain.subdominant_max), plain.unit_multiplicity);
  for (auto* values : {&result.low, &result.high})
    for (double& mu : *values) mu = shift(mu);
  for (auto* interval : {&result.interval_min, &result.interval_max})
    for (double& mu : *interval) mu = shift(mu);
  result.residual = omega * plain.residual;
  // What the solver found is as good as before; the accuracy asked for may be another.
  result.converged = plain.converged ? accurate(result, tolerance) : false;
  return result;
}

SolverChoice choose_solver(Index size, bool rigid, const SpectralOptions& options) {
  constexpr Index fallback_limit = 4000;
  const bool automatic = options.solver == SpectralSolver::automatic;
  if (size < arpack_smallest_size || (automatic && size <= options.dense_limit)) return {SpectralSolver::dense};
  if (automatic) return {SpectralSolver::shift_invert, rigid && size <= fallback_limit};
  return {options.solver};
}

SolverChoice choose_inexact_solver(Index size, const SpectralOptions& options) {
  constexpr Index dense_limit = 400, fallback_limit = 2500;  // the latter: what may be waited for
  const bool automatic = options.solver == SpectralSolver::automatic;
  if (options.solver == SpectralSolver::dense || size < arpack_smallest_size || (automatic && size <= dense_limit))
    return {SpectralSolver::dense};
  return {SpectralSolver::arpack, automatic && size <= fallback_limit};
}

SpectralRadius spectral_radius(const Contraction& b, const SpectralOptions& options, Continuation* memory) {
  const OneBlasThread serial_blas;
  const Index n = b.rows();
  if (n == 0) {
    SpectralRadius empty;
    empty.certified = options.certify;  // no eigenvalue can be missed
    return empty;
  }
  Continuation local;
  Continuation& known = memory != nullptr ? *memory : local;
  const SolverChoice choice = choose_solver(n, b.system.eta() == 0, options);
  SpectralRadius plain = choice.solver == SpectralSolver::dense    ? dense_radius(b, options)
                         : choice.solver == SpectralSolver::arpack ? arpack_radius(b, options, known)
                                                                   : shift_invert_radius(b, options, known);
  // A last resort, for small eta (docs/algorithms.md, section 7).
  if (!plain.converged && choice.dense_fallback) plain = dense_radius(b, options);
  return relaxed(plain, b.relaxation, options.tolerance);
}

}  // namespace nscdd
