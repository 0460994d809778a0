// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/rigid_motions.hpp"

namespace nscdd {

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
