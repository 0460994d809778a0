// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/rigid_motions.hpp"
#include "linalg/sparse_entries.hpp"
#include <nscdd/ddm/decomposition.hpp>

namespace nscdd {

/// The rigid limit of one subdomain: which velocities its contacts allow, with as many impulses as unknowns as are
/// independent. X_0 depends on the range of H_E only.
struct RigidSubdomain {
  RigidMotions motions;
  SparseMatrix a;            ///< A_E Z
  SparseMatrix h;            ///< a basis of the range of Z^T H_E: columns of it, and a few full ones (see RangeBasis)
  std::vector<char> hub;     ///< a flag for each body: a cluster so large that its motions are eliminated last of all
  std::vector<Index> early;  ///< columns of `h` that stay independent if the hubs are held
  std::vector<Index> late;   ///< the other columns, which are eliminated with the hubs
  bool conclusive = true;    ///< false if `h` may be no such basis
  double tilt = 0;           ///< of what `h` spans against the range, see RangeBasis

  /// Whether the motions of a body are eliminated beforehand, body by body, which leaves contact impulses alone: in
  /// space half as many unknowns, and next to a separator a quarter. All other impulses that act on it are then tied.
  bool condensed(std::size_t body) const { return motions.searched && !hub[body]; }
};

/// The rigid limit of S, whatever P.
struct RigidSystem {
  std::vector<RigidSubdomain> subdomains;
  /// Of every subdomain, those of other processes too: the motions of its hubs and its late impulses.
  std::vector<Index> hub_rows;
  bool conclusive = true;  ///< of all subdomains; else nothing can be proved with this system
  double tilt = 0;         ///< the largest of all subdomains: lambda may be off by so much
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

/// The block of the rigid limit: bodies that are no hubs, then the early impulses, and the hubs with the late impulses
/// of their subdomain among the border rows. A body that is condensed has no rows: impulses i and j that act on a
/// motion of mass m have -h_i h_j / m between them.
void add_rigid(SaddleEntries& entries, const RigidSystem& system, Index first_impulse, Index first_hub,
               Index interface);

}  // namespace nscdd
