// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"

namespace nscdd {

/// One linear system of the two-stage Newton method with one network in Stage 2.
struct FrozenInterface {
  Index iterations = 0;             ///< of the Krylov method, measured
  double predicted = not_a_number;  ///< the same, from the eigenvalues of P^-1 S alone; NaN above 2 500 unknowns
  /// Of Richardson's iteration F <- F + P^-1 (g - S F), from the spectral radius of I - P^-1 S; infinite from 1 on.
  double richardson = not_a_number;
};

/// A step by the two-stage Newton method, and the linear system at its end with each network in Stage 2.
struct InterfaceIterations {
  StepReport report;                   ///< of the step
  Index subdomains = 0, systems = 0;   ///< systems: linear systems solved
  Index stick = 0, slide = 0;          ///< contacts at the end
  FrozenInterface none, all, active;   ///< at these statuses, alpha = frozen_proximal W_nn
  Index undivided_factorisations = 0;  ///< of the same step on one subdomain
  /// Of the same step by other methods. The limit of all is solver.maximum_iterations.
  struct Rival {
    Index iterations = 0;
    bool converged = false;
  };
  Rival generic, enriched;  ///< Algorithm 1 with its defaults, to zeta <= 1e-4
  Rival admm;               ///< two-stage ADMM to the tolerance of the case, one solve at the interface in each

  /// 0 where sweeps alone solved the step.
  double iterations_per_system() const {
    return systems == 0 ? 0 : static_cast<double>(report.interface_iterations) / static_cast<double>(systems);
  }
};

/// alpha / W_nn of the linear systems that are compared: where Newton's steps begin.
inline constexpr double frozen_proximal = 1e-5;
/// Relative jumps that the iterations compared leave.
inline constexpr double frozen_tolerance = 1e-8;

/// Solves the next step of a simulation, whose solver is two_stage_newton, and compares.
InterfaceIterations interface_iterations(const Simulation& simulation);

}  // namespace nscdd
