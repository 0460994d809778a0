// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/granular_system.hpp"

namespace nscdd {

/// Releases the next grain of every source (Boundary::source) whose point is free: no grain would be touched, and
/// behind the first state no centre of a grain that impulses move is within GrainSource::distance.
/// The grain, which waited as a driven one, is at rest at the point then, and free. Grains leave in the order of their
/// numbers.
void release_grains(GranularSystem& system, GranularState& state);

/// Frees the grains of a system that are released in a state of it.
void free_released_grains(GranularSystem& system, const GranularState& state);

}  // namespace nscdd
