// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/primal_interface.hpp"
#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Vectors of the primal interface that a coarse problem solves exactly.
enum class CoarseSpace {
  none,
  rigid,  ///< rigid motions of each connected piece of a subdomain, weighted by D_E
  geneo,  ///< R_E^T D_E w of the local problems S_E w = lambda D_E^T R_E C R_E^T D_E w, lambda below a threshold
};
constexpr auto names_of(CoarseSpace) { return std::to_array<std::string_view>({"none", "rigid", "geneo"}); }

/// Candidates U of a coarse space, n_P x m, of norm 1 in C.
struct CoarseVectors {
  SparseMatrix u;
  Vector lambda;                  ///< of GenEO: ascending; else zeros
  std::vector<Index> subdomains;  ///< that each comes from
};

/// GenEO [Spillane, Dolean, Hauret, Nataf, Pechstein, Scheichl, Numer. Math. 126 (2014)]: all vectors with lambda <
/// `threshold`. With all of them in the coarse space, no eigenvalue of the balanced N C is above N_n / threshold.
CoarseVectors geneo_vectors(const PrimalInterface& interface, double threshold);
/// The threshold N_n / kappa, with which GenEO keeps a condition number.
inline double geneo_threshold(const PrimalInterface& interface, double kappa) {
  return static_cast<double>(interface.most_neighbours()) / kappa;
}

/// Needs the centres of the grains, and what their spins are where they turn (Subdomain::turning); throws Error
/// without. A piece that touches its own image in a periodic cell does not turn.
CoarseVectors rigid_vectors(const PrimalInterface& interface, const Decomposition& parts, const Period& period = {});

/// The coarse spaces spanned by the first vectors of a list: vectors V, orthonormal in C, with the span of the first k
/// for every k. A vector that depends on those before it to 10^-6 of its norm in C is left out.
class CoarseProblem {
 public:
  CoarseProblem(const PrimalInterface& interface, const CoarseVectors& vectors);

  Index size() const { return v_.cols(); }                              ///< independent vectors
  const Matrix& orthonormal() const { return v_; }                      ///< V
  bool is_orthonormal() const { return orthonormal_; }                  ///< to 1e-6, in spite of rounding
  const SparseMatrix& vectors() const { return u_; }                    ///< U, the independent ones
  const std::vector<Index>& subdomains() const { return subdomains_; }  ///< that each comes from
  /// Index one past the last vector with lambda < threshold.
  Index below(double threshold) const { return std::ranges::lower_bound(lambda_, threshold) - lambda_.begin(); }

  /// U (U^T C U)^-1 U^T p of the first k vectors: the coarse velocities that impulses p cause.
  Vector solve(const Vector& p, Index k) const;
  Vector solve(const Vector& p) const { return solve(p, size()); }
  CoarseProblem first(Index k) const;  ///< that of the first k vectors

 private:
  SparseMatrix u_;
  Matrix v_;
  Vector lambda_;
  std::vector<Index> subdomains_;
  bool orthonormal_ = true;
};

}  // namespace nscdd
