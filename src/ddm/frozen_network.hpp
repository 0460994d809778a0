// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/granular_decomposition.hpp"
#include "mechanics/connectivity.hpp"

namespace nscdd {

/// The network of one subdomain at frozen statuses in y = M^1/2 V, which has x, y and rim of every free body. A contact
/// that sticks has two columns (n, t), one that slides has one, an open one none (docs/theory.md, section 9).
struct FrozenNetwork {
  std::vector<BodyRows> rows;  ///< of every body in y
  Vector root;                 ///< M^1/2, an entry per row of y, kg^1/2
  SparseMatrix impulses;       ///< M^-1/2 G, the directions of impulses
  SparseMatrix resting;        ///< M^-1/2 N, the directions in which contacts keep v = 0
};

/// `statuses`: of the contacts of the subdomain, in their order.
FrozenNetwork frozen_network(const GranularSubdomain<2>& subdomain, const std::vector<ContactStatus>& statuses);

}  // namespace nscdd
