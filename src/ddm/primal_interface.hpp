// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/bddc.hpp>

namespace nscdd {

/// A subdomain condensed onto its n_b unknowns of shared grains, with M_{E,eps} = M_E + K_E / eps.
struct CondensedSubdomain {
  bool own = true;           ///< condensed by this rank
  std::vector<Index> local;  ///< these unknowns among all of the subdomain; means nothing on other ranks
  std::vector<Index> rows;   ///< their rows on the primal interface: R_E selects them
  Matrix flexibility;        ///< F_E, the block of M_{E,eps}^-1
  Matrix stiffness;          ///< S_E = F_E^-1, the Schur complement of M_{E,eps}
  Matrix block;              ///< the block of M_{E,eps}
  Matrix weights = {};       ///< D_E, see `weigh`
};

/// The interface in velocities: n_P = d times the number of shared grains, in the order of their gluing rows. It is the
/// primal form of X_eps:
///     C = sum_E R_E^T S_E R_E,    N = sum_E R_E^T D_E F_E D_E^T R_E,
/// N the balancing (Neumann-Neumann) preconditioner of C. The eigenvalues of N C other than 1 are those of the
/// Dirichlet preconditioner of FETI on X_eps; none is below 1 [Toselli and Widlund, Domain Decomposition, ch. 6].
/// Ranks condense their own subdomains; then each has all of it, as it has whole interface vectors, and the same bits.
struct PrimalInterface {
  Index dofs_per_grain = 2;
  Interface glued;  ///< of the shared grains alone, numbered in the order of their gluing rows
  Processes processes;
  std::vector<std::vector<Index>> sharing;  ///< subdomains of each shared grain, ascending
  std::vector<CondensedSubdomain> subdomains;

  Index size() const { return dofs_per_grain * count(sharing); }  ///< n_P
  bool definite() const;                     ///< false if a subdomain is not positive definite in double precision
  Index most_neighbours() const;             ///< N_n: the most subdomains that share grains with one, itself included
  Vector apply_dual(const Vector& f) const;  ///< X_eps f, of interface impulses
  Vector apply(const Vector& u) const;       ///< C u
  SparseMatrix sparse() const;               ///< C
  Matrix dense_preconditioner() const;       ///< N
};

/// Condenses the subdomains, 0 < flexibility < infinity. The gluing may have any shape. Collective.
PrimalInterface condense(const Decomposition& parts, double flexibility);

/// Sets the weights D_E of all subdomains.
void weigh(PrimalInterface& interface, Scaling scaling);

}  // namespace nscdd
