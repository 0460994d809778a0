// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/spectral_radius.hpp>

#include <algorithm>
#include <cmath>

namespace nscdd {

/// The three ways to find the ends of a spectrum, for omega = 1; chosen among in spectral_radius.cpp.
SpectralRadius dense_radius(const Contraction& b, const SpectralOptions& options);
SpectralRadius arpack_radius(const Contraction& b, const SpectralOptions& options, SpectralMemory& memory);
SpectralRadius shift_invert_radius(const Contraction& b, const SpectralOptions& options,
                                   SpectralMemory& memory);

/// Fills in everything that follows from the two ends of the spectrum of B outside ker S.
void set_ends(SpectralRadius& result, double mu_min, double mu_max, Index unit_multiplicity);

SpectralRadius not_converged(std::string_view solver);
SpectralRadius all_unit(Index size, std::string_view solver);  ///< S = 0, B = I

inline bool accurate(const SpectralRadius& radius, double tolerance) {
  return radius.residual <= tolerance * std::max(1.0, radius.value);
}

}  // namespace nscdd
