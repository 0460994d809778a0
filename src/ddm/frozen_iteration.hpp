// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/granular_two_stage.hpp"
#include "ddm/two_stage.hpp"
#include "linalg/range_projector.hpp"

namespace nscdd {

/// Algorithm 1 near a solution. The statuses of the contacts are frozen (open: no impulse; stick: v = 0; slide with v_t
/// of sign s: v_n = 0 and the impulse along n - s friction t). What remains is a linear iteration for the error of the
/// velocities. `apply` is one iteration of the algorithm itself, without loads, on y = M^1/2 V of all subdomains (three
/// entries per free body). So its spectral radius is the rate of convergence of a run as long as the statuses stay.
///
/// Errors lie in the range of M^-1/2 [G, A^T], which impulses can cause. Velocities that no impulse causes
/// (mechanisms) would be eigenvalues 1 that no run meets, so every image is projected on that range. As n_GS
/// grows, the radius tends to that of frozen_contraction.
class FrozenIteration {
 public:
  /// `parts`: the decomposition of the step (its velocities and impulses are not used); `statuses`: of the
  /// contacts of the step problem; `sweeps`: n_GS; `enriched`: X_eta, empty for the generic algorithm.
  FrozenIteration(GranularDecomposition<2> parts, std::vector<ContactStatus> statuses, Index sweeps,
                  std::optional<InterfaceOperator> enriched, double relaxation = 1);
  Index rows() const { return root_.size(); }
  /// So many iterations. The image is projected once: that costs as much as dozens of sweeps.
  Vector apply(const Vector& y, Index iterations = 1) const;
  Vector project(const Vector& y) const { return range_->apply(y); }

 private:
  void iterate(GranularDecomposition<2>& work) const;

  GranularDecomposition<2> parts_;
  GranularDecomposition<2> resting_;  // the same at rest and without contacts: what an application changes
  std::vector<ContactStatus> statuses_;
  Index sweeps_;
  std::optional<InterfaceOperator> enriched_;
  double relaxation_;
  Vector root_;  // of the inertia of every entry of y
  std::shared_ptr<const RangeProjector> range_;
};

/// The contraction of the interface with an exact Stage 1 at frozen statuses, n_Gamma x n_Gamma, dense:
///     B = I - omega P^-1 sum_E A_E (I - Pi_E) M_E^-1 A_E^T,   Pi_E = M_E^-1 G_E (N_E^T M_E^-1 G_E)^+ N_E^T
/// (docs/theory.md, section 9): G the directions of the impulses, N those in which
/// contacts keep v = 0. If nothing slides, P B is symmetric.
Matrix frozen_contraction(const GranularDecomposition<2>& parts, const std::vector<ContactStatus>& statuses,
                          const std::optional<InterfaceOperator>& enriched, double relaxation = 1);

/// The rate of a frozen map: its radius without unit eigenvalues, which are impulses that the networks carry
/// either way. It is converged if its residual is at most 1e-6. Where moduli crowd at 1, a power of the map tells them
/// apart sooner: `value` is the root of its radius, all else is of the power. An odd one keeps real eigenvalues apart.
MapRadius frozen_radius(const FrozenIteration& iteration, const ArpackOptions& options = {}, Index power = 1);
MapRadius frozen_radius(const Matrix& contraction);

}  // namespace nscdd
