// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/range_projector.hpp"
#include "linalg/sparse_entries.hpp"
#include <nscdd/ddm/decomposition.hpp>

namespace nscdd {

/// A grain, or a rigid cluster of grains (see rigid_clusters) with more contacts than can be independent.
struct RigidBody {
  Index first_row = 0, rows = 0;  ///< range of its motions among those of all bodies
  Index grains = 1;
};

/// The velocities of a network that its rigid clusters allow, V = Z q. Columns of Z are a translation for each
/// direction and the rotations about the centre of mass of each cluster, and the velocity of each other grain. Every V
/// with H^T V = 0 is of this form, and only contacts outside clusters still restrict q:
///     ker H^T = Z ker (Z^T H)^T,    rank H = rows of H - columns of Z + rank Z^T H.
struct RigidMotions {
  std::vector<RigidBody> bodies;
  Vector inertia;               ///< Z^T M Z, a diagonal matrix
  SparseMatrix z;               ///< Z; its columns have unit size: a rotation moves grains by about 1 m/s
  std::vector<Index> contacts;  ///< columns of H outside clusters, ascending
  SparseMatrix h;               ///< Z^T H of these
  bool searched = false;  ///< clusters were sought, and bodies may be set aside; else every body is a single grain
};

/// The motions of a network: d unknowns per grain, centres (d x n, m; empty if not known; needed for clusters), M, H.
RigidMotions rigid_motions(Index d, const Matrix& centres, const Vector& inertia, const SparseMatrix& h);

/// A basis of the range of `motions.h`. A body whose few columns are clearly independent is set aside with them,
/// repeatedly: the rest does not depend on it. A sparse factorisation chooses among the remaining columns.
RangeBasis range_basis(const RigidMotions& motions, Tilt tilt = Tilt::measured);

/// Rank of H, from that of Z^T H.
MatrixRank rigid_rank(Index d, const Matrix& centres, const Vector& inertia, const SparseMatrix& h);

}  // namespace nscdd
