// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/local_preconditioner.hpp"
#include <nscdd/ddm/bddc.hpp>

namespace nscdd {

/// What is computed at each epsilon of a sweep: X, X_eta, lumped with each scaling, and Dirichlet with each scaling and
/// coarse space, as far as listed. Empty lists stand for defaults.
struct CoarseParameters {
  std::vector<InterfacePreconditioner> preconditioners;  ///< dirichlet
  std::vector<Scaling> scalings;                         ///< multiplicity, deluxe
  std::vector<CoarseSpace> spaces;                       ///< none, geneo
  std::optional<double> kappa;      ///< that GenEO shall keep (30): its threshold is then N_n / kappa, which is safe
  std::optional<double> threshold;  ///< of GenEO instead
  bool counts = false;              ///< ranks and counts of the network and of its factors only
  Bddc bddc = {};                   ///< set by nscdd-mpi (nscdd/mpi/bddc.hpp)
};
/// Throws Error for parameters without effect, kappa <= 1 and a threshold <= 0. `option`: whether to name options.
void check_coarse(const CoarseParameters& parameters, bool option = false);

/// One preconditioner with one coarse space; nothing for counts.
struct CoarseMethod {
  std::optional<InterfacePreconditioner> preconditioner = {};
  std::optional<Scaling> scaling = {};
  CoarseSpace space = CoarseSpace::none;
};

/// Rows per epsilon, and the methods of each.
std::vector<CoarseMethod> methods_of(const CoarseParameters& parameters);

}  // namespace nscdd
