// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/strict_toml.hpp"
#include "simulation/dynamics.hpp"

namespace nscdd {

/// A [[boundary]] of a case file. Throws Error "file:line: key: expected ..., met ..." for anything else, for numbers
/// some of which are for the plane and others for space, and as check(BoundarySpec).
BoundarySpec read_boundary(StrictTable section);

}  // namespace nscdd
