// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/continuation.hpp"
#include <nscdd/ddm/spectral_radius.hpp>

#include <algorithm>
#include <cmath>

namespace nscdd {

/// Both ends by shift-invert, for omega = 1. The other ways, and the choice of one, are in spectral_radius.cpp.
SpectralRadius shift_invert_radius(const Contraction& b, const SpectralOptions& options, Continuation& memory);

/// Fills in everything that follows from the two ends of the spectrum of B outside ker S.
void set_ends(SpectralRadius& result, double mu_min, double mu_max, Index unit_multiplicity);

SpectralRadius not_converged(std::string_view solver, Index unit_multiplicity = 0);
SpectralRadius all_unit(Index size, std::string_view solver);  ///< S = 0, B = I

/// Error of an eigenvalue lambda = 1 - mu in units of max(1, |lambda|): digits of M are lost beside K/epsilon
/// and K/eta. The bound is several times the largest error seen against dense spectra (tests/laws).
inline double lost_to_rounding(const Contraction& b) {
  const double lightest = 0.25 * b.system.scale().maxCoeff(), epsilon = b.system.eta();  // 1/mass, 1/kg
  return 4e-16 * (1 + (epsilon > 0 ? lightest / epsilon : 0) + lightest / b.preconditioner.eta());
}

inline bool accurate(const SpectralRadius& radius, double tolerance) {
  return radius.residual <= tolerance * std::max(1.0, radius.value);
}

}  // namespace nscdd
