// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/connectivity.hpp"
#include "two_stage/granular_decomposition.hpp"

namespace nscdd {

/// Contact k of a subdomain frozen at a status, for small changes of its impulse and velocity. The plane needs only the
/// status. In space a sliding contact has the direction d and the `turning` of a FrozenContact at z = r - W^-1
/// (v + bias), the impulse that would stop it (docs/theory.md, section 9).
template <int D>
FrozenContact<D> frozen_as(ContactStatus status, const GranularSubdomain<D>& subdomain, std::size_t k);

/// All contacts of a step, in its order, at the impulses and velocities of their subdomains.
template <int D>
std::vector<FrozenContact<D>> frozen_contacts(const GranularDecomposition<D>& parts,
                                              const std::vector<ContactStatus>& statuses);

/// The tangent across the direction of sliding of a contact with a turning impulse.
TangentVector side_of(const FrozenContact<3>& contact);

/// The network of one subdomain at frozen statuses in y = M^1/2 V, with the unknowns of every free body. A sticking
/// contact has as many columns as there are dimensions, an open one none, a sliding one has one and, in space, a second
/// if its impulse turns (docs/theory.md, section 9). Velocities caused by impulses d obey N^T V + K d = 0.
struct FrozenNetwork {
  std::vector<BodyRows> rows;  ///< of every body in y
  Vector root;                 ///< M^1/2, an entry per row of y, kg^1/2
  SparseMatrix impulses;       ///< M^-1/2 G, the directions of impulses
  SparseMatrix resting;        ///< M^-1/2 N, the directions in which contacts keep v = 0
  Vector flexibility;          ///< K, an entry per column, 1/kg
  std::vector<Index> turning;  ///< columns of turning impulses, in the order of their contacts
};

/// `frozen`: the contacts of the subdomain, in their order.
template <int D>
FrozenNetwork frozen_network(const GranularSubdomain<D>& subdomain, const std::vector<FrozenContact<D>>& frozen);

}  // namespace nscdd
