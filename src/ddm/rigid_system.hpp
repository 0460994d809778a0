// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/rigid_motions.hpp"

namespace nscdd {

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
