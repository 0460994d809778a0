// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Throws Error, beginning with `what`, for a packing in space: what asks for it knows disks alone.
inline void require_plane(const Packing& packing, std::string_view what) {
  if (packing.dimension() != 2)
    throw Error(std::string(what) + ": expected disks in the plane, met spheres in space (a packing with a z)");
}

}  // namespace nscdd
