// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/rigid_system.hpp"
#include "linalg/sparse_entries.hpp"

namespace nscdd {

/// Entries of the lower triangle of both matrices of a family of saddle points.
struct SaddleEntries {
  SparseEntries inertia, stiffness;
  void add(Index row, Index column, double in_inertia, double in_stiffness) {
    inertia.add(row, column, in_inertia);
    stiffness.add(row, column, in_stiffness);
  }
};

/// The block of one decomposition: M_E and K_E = H_E H_E^T from a row on, and A_E in the interface rows.
void add_condensed(SaddleEntries& entries, const Decomposition& parts, Index first, Index interface);

/// M_E and A_E, with the contact impulses behind all grains: H_E^T in their rows, -1 to be multiplied by epsilon.
void add_augmented(SaddleEntries& entries, const Decomposition& parts, Index first_impulse, Index interface);

/// Where the rows of the rigid limit begin.
struct RigidRows {
  Index first_impulse = 0, first_hub = 0, interface = 0;
};

/// The block of the rigid limit: bodies that are no hubs, then the early impulses, and the hubs with the late impulses
/// of their subdomain among the border rows. A body that is condensed has no rows: impulses i and j that act on a
/// motion of mass m have -h_i h_j / m between them.
void add_rigid(SaddleEntries& entries, const RigidSystem& system, const RigidRows& rows);

}  // namespace nscdd
