// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/lu.hpp"
#include "two_stage/frozen_network.hpp"

namespace nscdd {

/// Response of a linear subdomain to the impulses of its interface.
template <int D>
struct LinearAnswer {
  std::vector<SweptVector<D>> impulses;      ///< of its contacts, N s
  std::vector<GrainVelocity<D>> velocities;  ///< of its bodies
  bool admissible = false;  ///< whether the contact law gives every contact the status it was frozen at
};

/// Stage 1 of a subdomain whose contacts keep their statuses: one solve with a stored factor. It starts at impulses r_0
/// and velocities V_0; Stage 2 then adds F' = -A_E^T (F - F_0). With G and N of docs/theory.md, section 9,
///     M (V - V_0) = G d + F',     N^T V + bias = -alpha d,     r = r_0 + (n, t) of d.
/// alpha > 0 makes hyperstatic networks regular. As alpha -> 0, V tends to an exact Stage 1 at these statuses. In space
/// no contact may slide with friction: its impulse would turn, which is not linear.
template <int D>
class LinearSubdomain {
 public:
  using Fields = std::function<SparseMatrix(const FrozenNetwork&)>;

  /// `statuses`: of the present impulses of the contacts. `flexibility`: alpha > 0, 1/kg. With `fields` the subdomain
  /// is homogenised: V - V_0 - M^-1 F' is a combination of fields, which coarse_velocities gives for its network, and M
  /// (V - V_0) = G d + F' holds for their powers only (Galerkin).
  LinearSubdomain(const GranularSubdomain<D>& subdomain, const ContactLaw& law, std::vector<ContactStatus> statuses,
                  double flexibility, const Fields& fields = {});

  bool regular() const { return !solver_ || regular_; }  ///< if false, nothing else may be called

  /// The answer at the present velocities of the subdomain: those last given or taken, plus changes by Stage 2.
  LinearAnswer<D> answer(const GranularSubdomain<D>& subdomain);

  /// Gives the subdomain the impulses and velocities of an answer; returns their sums.
  SweepSums take(LinearAnswer<D> answer, GranularSubdomain<D>& subdomain);

  /// Gives the subdomain the velocities of its impulses, V_0 + M^-1 (H (r - r_0) + F'). Only homogenised ones differ.
  void release(GranularSubdomain<D>& subdomain);

 private:
  Vector solve(const Vector& b) const;
  void follow(const GranularSubdomain<D>& subdomain);
  Vector strain(const std::vector<GrainVelocity<D>>& velocities) const;
  bool admits(const LinearAnswer<D>& answer) const;

  ContactLaw law_;
  std::vector<FrozenContact<D>> frozen_;
  ContactRows<D> contacts_;                // with r_0
  std::vector<GrainVelocity<D>> base_;     // V_0 + M^-1 F'
  std::vector<GrainVelocity<D>> present_;  // of the subdomain after the last call
  double flexibility_;
  FrozenNetwork network_;
  std::optional<SparseMatrix> fields_;  // times M^1/2
  SparseMatrix matrix_;                 // alpha + M^-1/2 G N^T M^-1/2, or its projection on the fields
  std::optional<SparseLu> solver_;
  bool regular_ = false;
};

}  // namespace nscdd
