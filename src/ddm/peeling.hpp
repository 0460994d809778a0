// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// What moves as one: a grain by itself, or a cluster of grains (see rigid_clusters) with more contacts than can be
/// independent.
struct RigidBody {
  Index first_row = 0, rows = 0;  ///< of its motions among those of all bodies
  Index grains = 1;
  Index grain = -1;  ///< the local number of a grain by itself
};

/// Columns of Z^T H, told apart by whether bodies could be set aside with them.
struct Peeled {
  std::vector<Index> set_aside;  ///< independent of each other and of all that are left
  std::vector<Index> left;       ///< ascending; none of them acts on a body that was set aside
};

/// Sets aside, again and again, each body that has few columns, all of them clearly independent by what they do to this
/// body alone. `grounded`: a flag for each body that does not move, or none; a column of such bodies alone is in
/// neither list. `h`: rows as the bodies have them.
Peeled peel(const std::vector<RigidBody>& bodies, const std::vector<char>& grounded, const SparseMatrix& h);

}  // namespace nscdd
