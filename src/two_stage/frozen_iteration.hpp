// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/range_projector.hpp"
#include "two_stage/granular_two_stage.hpp"
#include "two_stage/two_stage.hpp"

namespace nscdd {

/// Algorithm 1 near a solution, linearised: the statuses of the contacts are frozen (open: no impulse; stick: v = 0;
/// slide: v_n = 0 and an impulse on the edge of the cone). In the plane this edge is a line, n - s friction t with v_t
/// of sign s. In space it is round, and the tangent to first order takes its place: along n + friction d, and across d
/// the impulse turns with the velocity. `apply` is one iteration of the algorithm without loads, a linear map of the
/// error of the velocities. Its spectral radius is the rate of convergence of a run: in the plane as long as the
/// statuses stay, in space in the limit of small errors.
///
/// Errors are y = M^1/2 V of all subdomains, one entry for each unknown of a free body. In space a sweep renews a
/// turning impulse only in part, so y continues with W_tt^1/2 times its error across d.
///
/// Errors lie in the range of M^-1/2 [G, A^T], which impulses can cause, and images are projected on it: velocities
/// that no impulse causes would be eigenvalues 1 that no run meets. With n_GS the radius tends to frozen_contraction's.
template <int D>
class FrozenIteration {
 public:
  /// `parts`: the decomposition of the step, without use of its velocities and impulses; `frozen`: the contacts of the
  /// step, see frozen_contacts; `sweeps`: n_GS; `enriched`: X_eta, empty for the generic algorithm.
  FrozenIteration(GranularDecomposition<D> parts, std::vector<FrozenContact<D>> frozen, Index sweeps,
                  std::optional<InterfaceOperator> enriched, double relaxation = 1);
  Index rows() const { return root_.size(); }
  /// So many iterations. The image is projected once, as a projection costs as much as dozens of sweeps.
  Vector apply(const Vector& y, Index iterations = 1) const;
  Vector project(const Vector& y) const { return range_->apply(y); }
  const Vector& weights() const { return root_; }  ///< in y: of velocities, then of impulses

 private:
  void iterate(GranularDecomposition<D>& work, Vector& across) const;

  GranularDecomposition<D> parts_;
  GranularDecomposition<D> resting_;  // the same at rest and without contacts: copied by `apply`
  std::vector<FrozenContact<D>> frozen_;
  Index sweeps_;
  std::optional<InterfaceOperator> enriched_;
  double relaxation_;
  Vector root_;
  std::shared_ptr<const RangeProjector> range_;
};

/// The contraction of the interface with an exact Stage 1 at frozen statuses, n_Gamma x n_Gamma, dense:
///     B = I - omega P^-1 sum_E A_E (I - Pi_E) M_E^-1 A_E^T,   Pi_E = M_E^-1 G_E (N_E^T M_E^-1 G_E + K_E)^+ N_E^T
/// (docs/theory.md, section 9): G the directions of the impulses, N those in which contacts keep v = 0, K the
/// flexibility with which impulses turn in space. If nothing slides, P B is symmetric.
template <int D>
Matrix frozen_contraction(const GranularDecomposition<D>& parts, const std::vector<FrozenContact<D>>& frozen,
                          const std::optional<InterfaceOperator>& enriched, double relaxation = 1);

/// The rate of a frozen map: its radius without unit eigenvalues, which are self-stresses. Converged if the residual is
/// at most 1e-6. If moduli crowd at 1, a power of the map separates them sooner: `value` is then the root of the
/// power's radius, all else is of the power. An odd power keeps the signs of real eigenvalues.
template <int D>
MapRadius frozen_radius(const FrozenIteration<D>& iteration, Index power = 1) {
  const LinearMap map = [&](const Vector& y) { return iteration.apply(y, power); };
  MapRadius radius = map_radius(iteration.rows(), map, {.tolerance = 1e-6}, UnitEigenvalues::passed_over);
  if (power > 1) radius.value = std::pow(radius.value, 1 / static_cast<double>(power));
  return radius;
}
inline MapRadius frozen_radius(const Matrix& contraction) {
  return map_radius(contraction, {.tolerance = 1e-6}, UnitEigenvalues::passed_over);
}

}  // namespace nscdd
