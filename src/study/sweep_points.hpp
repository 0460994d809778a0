// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// The point with its flexibilities in 1/kg. `scale`: flexibility_scale of the case.
SweepPoint at_scale(SweepPoint point, const SweepParameters& parameters, double scale);

/// Fills in what follows at a point with an exact Stage 1 from the spectrum at omega = 1: the optimal relaxation where
/// that is asked for, the radius under the relaxation, and the dominant eigenvalue.
void set_exact(SweepResult& result, const SpectralRadius& plain, double tolerance);

}  // namespace nscdd
