// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/connectivity.hpp"
#include "two_stage/granular_decomposition.hpp"

namespace nscdd {

/// Contact k of a subdomain frozen at a status, for small changes about its impulse and velocity. The plane needs only
/// the status. In space a contact that slides has the direction d and the `turning` of a FrozenContact at
/// z = r - W^-1 (v + bias), the impulse that would stop it (docs/theory.md, section 9).
template <int D>
FrozenContact<D> frozen_as(ContactStatus status, const GranularSubdomain<D>& subdomain, std::size_t k);

/// All contacts of a step, in its numbers, at the present impulses and velocities of their subdomains.
template <int D>
std::vector<FrozenContact<D>> frozen_contacts(const GranularDecomposition<D>& parts,
                                              const std::vector<ContactStatus>& statuses);

/// Tangent of a contact with a turning impulse, across its direction of sliding.
TangentVector side_of(const FrozenContact<3>& contact);

/// The network of one subdomain at frozen statuses in y = M^1/2 V, which has the unknowns of every free body. A contact
/// that sticks has as many columns as there are dimensions, one that slides has one, and in space a second for what
/// turns its direction; an open one has none (docs/theory.md, section 9). The velocities that impulses d lead to obey
/// N^T V + K d = 0 with a diagonal K, which is 0 but for those that turn.
struct FrozenNetwork {
  std::vector<BodyRows> rows;  ///< of every body in y
  Vector root;                 ///< M^1/2, an entry per row of y, kg^1/2
  SparseMatrix impulses;       ///< M^-1/2 G, the directions of impulses
  SparseMatrix resting;        ///< M^-1/2 N, the directions in which contacts keep v = 0
  Vector flexibility;          ///< K, an entry per column, 1/kg
  std::vector<Index> turning;  ///< columns of impulses that turn, in the order of their contacts
};

/// `frozen`: the contacts of the subdomain, in their order.
template <int D>
FrozenNetwork frozen_network(const GranularSubdomain<D>& subdomain, const std::vector<FrozenContact<D>>& frozen);

}  // namespace nscdd
