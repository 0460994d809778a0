// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/strict_toml.hpp"
#include "simulation/dynamics.hpp"

namespace nscdd {

/// One [[boundary]] of a case file. Throws Error "file:line: key: expected ..., met ..." for anything that is not a
/// boundary, for numbers of which some are for the plane and others for space, and as check(BoundarySpec).
BoundarySpec read_boundary(StrictTable section);

}  // namespace nscdd
