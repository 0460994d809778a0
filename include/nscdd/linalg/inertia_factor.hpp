// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/processes.hpp>

namespace nscdd {

/// A = L D L^T, up to a permutation, of a sparse symmetric n x n matrix: by Sylvester's law of inertia D has as many
/// negative eigenvalues as A. Most solutions are wanted only on the border, the last m rows; E = [0; I], n x m.
///
/// If ranks share a matrix, A is the sum of their parts. Each rank holds the lower triangle of its part: its own rows
/// and the border, which is common to all. Vectors have the own rows and the whole border.
struct InertiaFactor {
  using Solve = std::function<Vector(const Vector&)>;
  bool regular = false;            ///< false if the factorisation broke down; other members are then invalid
  Index negative_eigenvalues = 0;  ///< of A, with multiplicity
  Solve solve;                     ///< b -> A^-1 b
  Solve solve_from_border;         ///< g -> A^-1 E g
  Solve solve_to_border;           ///< b -> E^T A^-1 b
  Solve solve_on_border;           ///< g -> E^T A^-1 E g
};

/// Pattern of a family of matrices, factorised one after the other.
struct InertiaPattern {
  SparseMatrix lower;  ///< n x n, lower triangle, values ignored
  /// Group of each row, 0 ... groups - 1, or -1: any group that it touches, preferably one with interior rows. Rows of
  /// a group should be eliminated together: a multiplier of a saddle point belongs with the rows it ties, unless their
  /// block is definite. Groups of border rows only may be eliminated last, which keeps the border small.
  std::vector<Index> group;
  Index border = 0;  ///< m; rows outside the groups of the border are the interior
};

struct InertiaFamily {
  /// Factorises the matrix with this lower triangle. Matrices with equal `parameters` have equal interiors.
  std::function<InertiaFactor(const SparseMatrix& lower, const std::array<double, 2>& parameters)> factorise;
  std::function<void()> release;  ///< frees the interior
};

/// A factorisation method, as a record of functions.
struct InertiaMethod {
  std::string name;
  std::function<InertiaFamily(const InertiaPattern&)> analyse;
};

/// Our multifrontal factorisation (src/linalg/multifrontal/README.md). It keeps the factored interior, and skips it in
/// solves on the border. The bits do not depend on the number of threads. `work`: counts its operations.
InertiaMethod multifrontal(std::shared_ptr<WorkCount> work = std::make_shared<WorkCount>());

/// Error of a factor: ||d|| / ||x|| on the border, x = A^-1 E 1, d its first correction by iterative refinement.
double inexactness(const InertiaFactor& factor, const SparseMatrix& lower, Index border,
                   const Processes& processes = {});

/// Inexactness below which the inertia and solutions of a factor are used.
inline constexpr double reliable_inexactness = 1e-3;

/// Settings of ARPACK, the matrix-free solver of eigenvalue problems, which factorises nothing.
struct ArpackOptions {
  Index basis = 40;              ///< Krylov vectors kept (ncv), cut to the size of the problem
  Index maximum_restarts = 300;  ///< implicit restarts
  double tolerance = 1e-12;      ///< relative accuracy asked of the Ritz values
};

/// b - A x for a symmetric matrix given by its lower triangle.
Vector symmetric_residual(const SparseMatrix& lower, const Vector& x, const Vector& b);
/// E g - A x, for a matrix that ranks may share.
Vector border_residual(const SparseMatrix& lower, const Vector& x, const Vector& g, const Processes& processes);

}  // namespace nscdd
