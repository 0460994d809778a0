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
  Index grain = -1;  ///< local number of a single grain; -1 for a cluster
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

/// A basis of the range of `motions.h`, or with `grounded` (a flag for each body that does not move) of the range
/// without the rows of grounded bodies. A body whose few columns are clearly independent is set aside with them,
/// repeatedly: the rest does not depend on it. A sparse factorisation chooses among the remaining columns.
RangeBasis range_basis(const RigidMotions& motions, const std::vector<char>& grounded = {}, Tilt tilt = Tilt::measured);

/// Rank of H, from that of Z^T H.
MatrixRank rigid_rank(Index d, const Matrix& centres, const Vector& inertia, const SparseMatrix& h);

/// The rigid limit of one subdomain: its motions, and a basis of independent impulses. X_0 depends only on their range.
struct RigidSubdomain {
  RigidMotions motions;
  SparseMatrix a;            ///< A_E Z
  SparseMatrix h;            ///< a basis of the range of Z^T H_E: some of its columns, and a few full ones (RangeBasis)
  std::vector<char> hub;     ///< a flag for each body: a large cluster, whose motions are eliminated last
  std::vector<Index> early;  ///< columns of `h` that are independent with the hubs at rest
  std::vector<Index> late;   ///< the other columns, eliminated with the hubs
  bool conclusive = true;    ///< false if `h` may be no such basis
  double tilt = 0;           ///< angle between the span of `h` and the range, see RangeBasis

  /// Whether the motions of a body are eliminated beforehand: half the unknowns in space, but coupled impulses.
  bool condensed(std::size_t body) const { return motions.searched && !hub[body]; }
};

/// The rigid limit of S, for any P.
struct RigidSystem {
  std::vector<RigidSubdomain> subdomains;
  std::vector<Index> hub_rows;  ///< of each subdomain, on all ranks: motions of its hubs, late impulses
  bool conclusive = true;       ///< in all subdomains; else this system proves nothing
  double tilt = 0;              ///< the largest of all subdomains: error of lambda
};

RigidSystem rigid_system(const Decomposition& parts);

/// Entries of the lower triangle of both matrices of a family of saddle points, see shifted_pencil.hpp.
struct SaddleEntries {
  SparseEntries inertia, stiffness;
  void add(Index row, Index column, double in_inertia, double in_stiffness) {
    inertia.add(row, column, in_inertia);
    stiffness.add(row, column, in_stiffness);
  }
};

/// The block of the rigid limit: bodies that are no hubs, then the early impulses; among the border rows the hubs of
/// each subdomain with its late impulses. A condensed body has no rows: mass m adds -h_i h_j / m.
void add_rigid(SaddleEntries& entries, const RigidSystem& system, Index first_impulse, Index first_hub,
               Index interface);

}  // namespace nscdd
