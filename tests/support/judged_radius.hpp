// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/spectra/spectral_radius.hpp>

namespace nscdd::testing {

/// spectral_radius by shift-invert: checks every inertia that the search asks for against that of MUMPS.
SpectralRadius judged_radius(const Contraction& b, SpectralOptions options);

}  // namespace nscdd::testing
