// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/range_projector.hpp"

namespace nscdd {

/// What moves as one: a grain by itself, or a cluster of grains (see rigid_clusters) with more contacts than can be
/// independent.
struct RigidBody {
  Index first_row = 0, rows = 0;  ///< of its motions among those of all bodies
  Index grains = 1;
  Index grain = -1;  ///< the local number of a grain by itself
};

/// The velocities of a network that its rigid clusters leave: V = Z q with a translation for each direction and the
/// rotations about the centre of mass for each cluster, and the velocity for each other grain. Every V with H^T V = 0
/// is of this kind, and H^T Z q = 0 is left to be asked of the contacts that are not within a cluster. So
///     ker H^T = Z ker (Z^T H)^T,    rank H = rows of H - columns of Z + rank Z^T H.
struct RigidMotions {
  std::vector<RigidBody> bodies;
  Vector inertia;               ///< Z^T M Z, a diagonal matrix
  SparseMatrix z;               ///< Z, its columns of unit size: a rotation moves the grains by about 1 m/s
  std::vector<Index> contacts;  ///< columns of H that are not within a cluster, ascending
  SparseMatrix h;               ///< Z^T H of these
  bool searched = false;        ///< for clusters, and bodies may be set aside; false where each grain is by itself
};

/// The motions of a network: d unknowns per grain, centres (d x n, m; empty where not known), the diagonal of M, and H.
/// Clusters are sought in space only: in the plane dependent contacts are found and left out without them.
RigidMotions rigid_motions(Index d, const Matrix& centres, const Vector& inertia, const SparseMatrix& h);

/// A basis of the range of Z^T H as in `motions.h`. With `grounded`, a flag for each body that does not move: of what
/// these bodies leave of the range. A body whose few columns are clearly independent is set aside with them, again and
/// again: the rest does not depend on them. A sparse factorisation chooses among the columns of the bodies that are
/// left.
RangeBasis range_basis(const RigidMotions& motions, const std::vector<char>& grounded = {}, Tilt tilt = Tilt::measured);

/// Rank of H, from that of Z^T H.
MatrixRank rigid_rank(Index d, const Matrix& centres, const Vector& inertia, const SparseMatrix& h);

}  // namespace nscdd
