// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/granular_system.hpp"

namespace nscdd {

/// Releases the next grain of every source (Boundary::source) whose point is free, in the first state whether it is or
/// not: no centre of a grain that impulses move is within GrainSource::distance, and no grain at all would be touched.
/// The grain, which waited as a driven one, is at rest at the point then, and free. Grains leave in the order of their
/// numbers.
void release_grains(GranularSystem& system, GranularState& state);

/// Frees the grains of a system that are released in a state of it.
void free_released_grains(GranularSystem& system, const GranularState& state);

}  // namespace nscdd
