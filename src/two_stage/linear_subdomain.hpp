// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/lu.hpp"
#include "two_stage/granular_decomposition.hpp"

namespace nscdd {

/// All contacts of a step, in its order, at the impulses and velocities of their subdomains.
template <int D>
std::vector<FrozenContact<D>> frozen_contacts(const GranularDecomposition<D>& parts,
                                              const std::vector<ContactStatus>& statuses);

/// The tangent across the direction of sliding of a contact with a turning impulse.
TangentVector side_of(const FrozenContact<3>& contact);

/// The network of one subdomain at frozen statuses in y = M^1/2 V, with the unknowns of every free body. A sticking
/// contact has as many columns as there are dimensions, an open one none, a sliding one has one and, in space, a second
/// if its impulse turns (docs/theory.md, section 9). Velocities caused by impulses d obey N^T V + K d = 0.
struct FrozenNetwork {
  std::vector<BodyRows> rows;  ///< of every body in y
  Vector root;                 ///< M^1/2, an entry per row of y, kg^1/2
  SparseMatrix impulses;       ///< M^-1/2 G, the directions of impulses
  SparseMatrix resting;        ///< M^-1/2 N, the directions in which contacts keep v = 0
  Vector flexibility;          ///< K, an entry per column, 1/kg
  std::vector<Index> turning;  ///< columns of turning impulses, in the order of their contacts
};

/// `frozen`: the contacts of the subdomain, in their order.
template <int D>
FrozenNetwork frozen_network(const GranularSubdomain<D>& subdomain, const std::vector<FrozenContact<D>>& frozen);

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
  LinearSubdomain(const GranularSubdomain<D>& subdomain, const ContactLaw& law,
                  const std::vector<ContactStatus>& statuses, double flexibility, const Fields& fields = {});

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
