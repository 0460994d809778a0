// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/coarse_space.hpp"
#include "linalg/krylov.hpp"

namespace nscdd {

enum class LocalStiffness {
  lumped,     ///< the block of M_{E,eps} on shared grains
  dirichlet,  ///< S_E
};

/// The lumped or Dirichlet preconditioner of X_eps in interface impulses [Farhat and Roux 1991; Toselli and Widlund,
/// ch. 6], with the coarse space of the primal interface built into its jump operator:
///     P^-1 = sum_E B_E S_E B_E^T,  B^T g: the velocities w of the copies with jumps g, of zero weighted mean on the
/// C-complement of the coarse space: U^T sum_E R_E^T S_E w_E = 0. So P^-1 X_eps is symmetric in P, and has the upper
/// spectrum of the balanced N C: all eigenvalues other than 1. Returns g -> P^-1 g.
/// `interface`: weighted; `coarse` needs LocalStiffness::dirichlet. Every rank computes all of a product.
LinearMap local_preconditioner(std::shared_ptr<const PrimalInterface> interface, LocalStiffness stiffness,
                               std::shared_ptr<const CoarseProblem> coarse = {});

}  // namespace nscdd
