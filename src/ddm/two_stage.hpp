// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/ddm/decomposition.hpp>
#include <nscdd/ddm/interface_operator.hpp>
#include <nscdd/mechanics/law.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace nscdd {

/// What Algorithm 1 carries from one iteration to the next.
struct TwoStageState {
  Vector interface_impulses;     ///< F_Gamma, n_Gamma
  std::vector<Vector> impulses;  ///< r_E of every subdomain, c_E each: start of the Gauss-Seidel sweeps
};

/// The two-stage iteration itself ([ADI12] Algorithm 1 and its enriched form) with the linear law:
///   Stage 1  (W_E + epsilon I) r_E = -v_E^d + Ahat_E^T F    exactly, or by n_GS Gauss-Seidel sweeps
///            V_E = M_E^-1 (F_E^d + H_E r_E - A_E^T F)
///   Stage 2  F <- F + omega X_eta^-1 sum_E A_E V_E
/// Stage 2 in this form is the paper's (16), with any eta and any law. For its right-hand side
/// F^d + H (r + v/eta) equals M_{E,eta} V_E + A_E^T F, so X_eta F' = sum A_E V_E + X_eta F.
class TwoStageIteration {
 public:
  /// `stage_one`: the decomposition with the contacts Stage 1 works with (all, or the active ones);
  /// `preconditioner`: X_eta of the same gluing; `sweeps`: n_GS >= 1, or empty for an exact Stage 1.
  /// Throws Error for sweeps < 1.
  TwoStageIteration(const Decomposition& stage_one, const Law& law, InterfaceOperator preconditioner,
                    std::optional<Index> sweeps, double relaxation = 1.0);

  /// All unknowns are zero, as at the start of a time step in Algorithm 1.
  TwoStageState zero_state() const;

  /// One iteration under local loads F_E^d, one vector d n_E per subdomain. Without loads it propagates the
  /// error of the linear problem.
  TwoStageState iterate(TwoStageState state, const std::vector<Vector>* loads = nullptr) const;

  bool rigid() const;  ///< the law is the rigid limit, epsilon = 0
  Index interface_size() const;
  Index contacts() const;  ///< of all subdomains together

  class Implementation;

 private:
  std::shared_ptr<const Implementation> implementation_;
};

/// The loads M_E V_E^- of grains that arrive with velocity V^- (d n entries).
std::vector<Vector> impact_loads(const Decomposition& parts, const Vector& arriving_velocity);

}  // namespace nscdd
