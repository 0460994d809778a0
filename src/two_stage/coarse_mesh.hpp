// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "two_stage/frozen_network.hpp"

namespace nscdd {

/// Where a body of a subdomain is, and whether it is kept as it is in a homogenised subdomain.
struct PlacedBody {
  std::array<double, 2> centre{0, 0};  ///< m
  double radius = 0;                   ///< m
  bool kept = false;
};

/// Columns that span M^1/2 times the velocities of a homogenised subdomain, in the rows of its network. Bodies that are
/// kept have three columns each. The others move with the bilinear functions of a mesh of cells[0] x cells[1] equal
/// cells over the box of their centres: x, y and spin (rim / radius) are interpolated between its nodes. Of dependent
/// columns, at nodes near too few bodies, only independent ones are taken: a mesh as fine as the bodies leaves all of
/// them free. `bodies`: in the order of the subdomain; those without rows are left out.
SparseMatrix coarse_velocities(const FrozenNetwork& network, const std::vector<PlacedBody>& bodies,
                               const std::array<Index, 2>& cells);

}  // namespace nscdd
