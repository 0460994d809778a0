// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>
#include <nscdd/ddm/decomposition.hpp>

namespace nscdd {

/// Weights D_E of the copies of shared grains, with sum_E R_E^T D_E R_E = I.
enum class Scaling {
  multiplicity,  ///< 1/q, q copies of the grain
  stiffness,     ///< the diagonal of M_{E,eps} over its sum
  deluxe,        ///< (sum_E' S_E')^-1 S_E on each class of grains that the same subdomains share
};
constexpr auto names_of(Scaling) { return std::to_array<std::string_view>({"multiplicity", "stiffness", "deluxe"}); }

/// Balancing domain decomposition by constraints. Velocities of grains that three or more subdomains share are primal.
struct BddcParameters {
  double flexibility = 1;  ///< epsilon, 1/kg, 0 < epsilon < infinity
  Scaling scaling = Scaling::deluxe;
  std::optional<double> threshold = {};  ///< of adaptive constraints; with deluxe weights the wanted condition number
};

/// A solution of (M + K/epsilon) V = b by conjugate gradients with BDDC, to a relative residual of 1e-8.
struct BddcSolution {
  Vector right_hand_side, velocities;  ///< b and V: unknowns of the grains that have contacts, in their order
  Index iterations = 0;
  Index coarse_size = 0;                  ///< primal velocities and adaptive constraints
  double lambda_min = 1, lambda_max = 1;  ///< of the preconditioned matrix, as conjugate gradients see it
  double setup_seconds = 0, seconds = 0;  ///< of the preconditioner, and of the iterations
  double residual = 0;                    ///< |b - (M + K/epsilon) V| / |b| by our own matrices
  bool converged = false;
};

/// Solves for a b drawn at random, always the same. Collective; nscdd/mpi/bddc.hpp makes one.
using BddcSolver = std::function<BddcSolution(const Decomposition& own, const BddcParameters& parameters)>;

}  // namespace nscdd
