// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/boundary.hpp"

namespace nscdd {

/// The bodies of the clumps of a packing with masses m_i, ascending by their numbers, at rest and free along all
/// directions. Every grain counts whole, also where it overlaps others of its clump (as by default in YADE):
///     m = sum m_i,   c = sum m_i x_i / m,   I = sum m_i (k r_i^2 1 + |d_i|^2 1 - d_i d_i^T),   d_i = x_i - c,
/// k = 1/2 in the plane, 2/5 in space. In a periodic cell members are the images that are nearest to the first one.
std::vector<BoundarySpec> clumps_of(const Packing& packing, const Period& period);

/// Adds these bodies to the boundaries of a case, but for clumps whose grains a boundary has already. Throws Error for
/// a boundary that has some grains of a clump only, or the name of one.
void add_clumps(std::vector<BoundarySpec>& boundaries, const Packing& packing, const Period& period);

}  // namespace nscdd
