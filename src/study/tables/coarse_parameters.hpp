// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/coarse_space.hpp"

namespace nscdd {

/// Preconditioners of the interface problem X_eps F = g.
enum class InterfacePreconditioner {
  inertia,    ///< X, Stage 2 of the generic algorithm
  network,    ///< X_eta with eta = 10 eps, Stage 2 of the enriched algorithm
  lumped,     ///< see LocalPreconditioner
  dirichlet,  ///< the same; it alone takes a coarse space
};
constexpr auto names_of(InterfacePreconditioner) {
  return std::to_array<std::string_view>({"X", "X_eta", "lumped", "dirichlet"});
}

/// What is computed at each epsilon of a sweep: X, X_eta, lumped with each scaling, and Dirichlet with each scaling and
/// coarse space, as far as listed.
struct CoarseParameters {
  std::vector<InterfacePreconditioner> preconditioners{InterfacePreconditioner::dirichlet};
  std::vector<Scaling> scalings{Scaling::multiplicity, Scaling::deluxe};
  std::vector<CoarseSpace> spaces{CoarseSpace::none, CoarseSpace::geneo};
  double kappa = 30;                     ///< wanted: GenEO takes the threshold N_n / kappa, which is safe
  std::optional<double> threshold = {};  ///< of GenEO instead
  bool counts = false;                   ///< ranks and counts of the network and of factors only
};
/// Throws Error for kappa <= 1 and a threshold <= 0. `dashes`: prefix of option names.
void check_coarse(const CoarseParameters& parameters, std::string_view dashes = "");

/// One preconditioner with one coarse space.
struct CoarseMethod {
  InterfacePreconditioner preconditioner = InterfacePreconditioner::dirichlet;
  std::optional<Scaling> scaling = {};
  CoarseSpace space = CoarseSpace::none;
};

/// Rows per epsilon, and the methods of each.
std::vector<CoarseMethod> methods_of(const CoarseParameters& parameters);

}  // namespace nscdd
