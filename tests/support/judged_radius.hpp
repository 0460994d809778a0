// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/spectra/spectral_radius.hpp>

namespace nscdd::testing {

/// spectral_radius by shift-invert, with every inertia that the search asks for judged by MUMPS: checks that
/// no count differs.
SpectralRadius judged_radius(const Contraction& b, SpectralOptions options);

}  // namespace nscdd::testing
