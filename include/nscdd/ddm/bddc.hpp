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
  Scaling scaling = Scaling::deluxe;
  std::optional<double> threshold = {};  ///< of adaptive constraints; with deluxe weights the wanted condition number
  double tolerance = 1e-8;               ///< of the residual, relative to the right-hand side
  Index maximum_iterations = 5000;
};

/// A solution by conjugate gradients.
struct BddcSolution {
  Vector velocities;  ///< R_E V, those of the subdomain of this rank
  Index iterations = 0;
  double lambda_min = 1, lambda_max = 1;  ///< of the preconditioned matrix, as the iterations see it
  double flops = 0;                       ///< of this rank
  double seconds = 0;
  bool converged = false;
};

/// The system (sum_E R_E^T M_{E,eps} R_E) V = sum_E R_E^T b_E of all ranks, with its preconditioner.
struct BddcSystem {
  std::vector<Index> unknowns;  ///< of V, for each row of M_{E,eps}
  Index size = 0;               ///< of V: unknowns of the grains that have contacts, in their order
  Index coarse_size = 0;        ///< primal velocities and adaptive constraints
  double setup_flops = 0;       ///< of this rank
  double setup_seconds = 0;
  std::function<BddcSolution(const Vector& right)> solve;  ///< of b_E; collective
};

/// Prepares the system of symmetric positive definite M_{E,eps}, one for each rank. Collective; see nscdd/mpi/bddc.hpp.
using Bddc = std::function<BddcSystem(const Decomposition& own, SparseMatrix matrix, const BddcParameters& parameters)>;

}  // namespace nscdd
