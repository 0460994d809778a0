// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/coarse_space.hpp"

#include <map>

namespace nscdd {

/// The spectrum of N C on the C-complement of the first k vectors of a coarse space (see PrimalInterface). Its smallest
/// eigenvalue is 1 or more, so that the largest bounds the condition number.
class BalancedSpectrum {
 public:
  /// `interface`: weighted; it and `coarse` must outlive this.
  BalancedSpectrum(const PrimalInterface& interface, const CoarseProblem& coarse);

  /// The largest eigenvalue by Lanczos on B^T (C - C U (U^T C U)^-1 U^T C) B, N = B B^T. 1: none is left; NaN: stalled.
  double largest(Index k) const;
  /// The smallest k with largest(k) <= kappa, by bisection; nothing if all vectors do not suffice.
  std::optional<Index> fewest(double kappa) const;

  /// All eigenvalues, ascending; empty above `dense_limit` unknowns of the primal interface.
  Vector all(Index k) const;
  /// Eigenvalues above a shift, by the inertia of [shift I - L^T N L, L^T U; U^T L, 0], C = L L^T; nothing above
  /// `dense_limit` unknowns, or if LAPACK fails.
  std::optional<Index> above(double shift, Index k) const;

  /// The relative width within which inertia counts prove that `highest` is the largest eigenvalue and none is below
  /// `lowest`; nothing if they do not, or if V is not orthonormal. It is `end_width`, or what rounding of L^T N L may
  /// do if that is more, and `largest_width` at most.
  std::optional<double> proved_width(double lowest, double highest, Index k) const;

  static constexpr Index dense_limit = 5000;
  static constexpr double end_width = 1e-6, largest_width = 1e-3;

 private:
  const Matrix& whitened() const;  // L^T N L
  Matrix whitened_vectors(Index k) const;

  const PrimalInterface& interface_;
  const CoarseProblem& coarse_;
  std::vector<Matrix> roots_;  // D_E times the Cholesky factor of F_E
  mutable std::optional<Matrix> lower_, whitened_;
  mutable std::map<Index, double> known_;
};

/// No deflation by fewer vectors reaches the condition number kappa on a symmetric pencil with these eigenvalues
/// (ascending, positive), by Cauchy's interlacing: the least over a of max(#{lambda < a}, #{lambda > kappa a}).
Index fewest_deflated(const Vector& eigenvalues, double kappa);

}  // namespace nscdd
