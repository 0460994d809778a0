// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/spectrum_ends.hpp"

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

SpectralRadius spectral_radius(const Contraction& b, const SpectralOptions& options, Continuation* memory) {
  const Index n = b.rows();
  if (n == 0) {
    SpectralRadius empty;
    empty.certified = options.certify;  // no eigenvalue can be missed
    return empty;
  }
  Continuation local;
  SpectralRadius plain;
  if (options.solver == SpectralSolver::dense || n < arpack_smallest_size ||
      (options.solver == SpectralSolver::automatic && n <= options.dense_limit)) {
    plain = dense_radius(b, options);
  } else if (options.solver == SpectralSolver::arpack) {
    plain = arpack_radius(b, options, memory != nullptr ? *memory : local);
  } else {
    plain = shift_invert_radius(b, options, memory != nullptr ? *memory : local);
    // A last resort, for small eta (docs/theory.md).
    if (options.solver == SpectralSolver::automatic && !plain.converged && b.system.eta() == 0 &&
        n <= rigid_dense_limit)
      plain = dense_radius(b, options);
  }
  return relaxed(plain, b.relaxation, options.tolerance);
}

}  // namespace nscdd
