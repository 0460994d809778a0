// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/coarse_space.hpp"
#include "linalg/krylov.hpp"

namespace nscdd {

/// Preconditioners of the interface problem X_eps F = g of a network, or S F = g of the contacts of a step.
enum class InterfacePreconditioner {
  inertia,    ///< X, Stage 2 of the generic algorithm
  network,    ///< X_eta of all contacts with eta = 10 eps, Stage 2 of the enriched algorithm
  active,     ///< the same of the contacts of X_eps, or of the active directions of S
  lumped,     ///< of the blocks of M_{E,eps} on shared grains, see local_preconditioner
  dirichlet,  ///< of S_E, the same; it alone takes each coarse space
  bddc,       ///< of PETSc, in velocities, see BddcParameters; geneo means its adaptive constraints
};
constexpr auto names_of(InterfacePreconditioner) {
  return std::to_array<std::string_view>({"X", "X_eta", "X_eta_active", "lumped", "dirichlet", "bddc"});
}
constexpr bool is_local(InterfacePreconditioner one) {
  return one == InterfacePreconditioner::lumped || one == InterfacePreconditioner::dirichlet;
}
constexpr bool is_enriched(InterfacePreconditioner one) {
  return one == InterfacePreconditioner::network || one == InterfacePreconditioner::active;
}

/// The lumped or Dirichlet preconditioner of X_eps in interface impulses [Farhat and Roux 1991; Toselli and Widlund,
/// ch. 6], with the coarse space of the primal interface built into its jump operator:
///     P^-1 = sum_E B_E S_E B_E^T,  B^T g: the velocities w of the copies with jumps g, of zero weighted mean on the
/// C-complement of the coarse space: U^T sum_E R_E^T S_E w_E = 0. So P^-1 X_eps is symmetric in P, and has the upper
/// spectrum of the balanced N C: all eigenvalues other than 1. Returns g -> P^-1 g.
/// `interface`: weighted; `kind`: lumped or dirichlet, which `coarse` needs. Every rank computes all of a product.
LinearMap local_preconditioner(std::shared_ptr<const PrimalInterface> interface, InterfacePreconditioner kind,
                               std::shared_ptr<const CoarseProblem> coarse = {});

}  // namespace nscdd
