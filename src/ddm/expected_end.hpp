// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/continuation.hpp"
#include "ddm/pencil_end.hpp"
#include <nscdd/ddm/spectral_radius.hpp>

#include <optional>

namespace nscdd {

/// Where one end of the spectrum is expected at a point of a sweep, from what was found at the points visited
/// last, on logarithmic axes: by Taylor's formula from the slopes at the last point, and if the two last
/// points and this one differ in epsilon alone or in eta alone, by Hermite's cubic through both. None if
/// nothing was visited.
std::optional<EndGuess> expected_end(const PencilMemory& memory, const PencilPoint& point,
                                     PencilMemory::End PencilMemory::Visited::*end);

}  // namespace nscdd
