// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/interface_operator.hpp>
#include <nscdd/ddm/schwarz.hpp>
#include <nscdd/mechanics/law.hpp>

#include <variant>

namespace nscdd {

/// Stage 2 of the generic algorithm ([ADI12] Algorithm 1): X F' = f + sum_E A_E M_E^-1 H_E r_E, inertia only.
struct Generic {
  static constexpr std::string_view name = "generic";
  double flexibility() const { return infinity; }  ///< Stage 2 sees no network
};

/// Stage 2 of the enriched algorithm ([ADI12] eqs. (15)-(17)): X_eta, eta > 0 in 1/kg; eta = infinity is generic.
struct Enriched {
  static constexpr std::string_view name = "enriched";
  double eta = 1.0;
  double flexibility() const { return eta; }
};

/// Stage 2 of the two-stage algorithm: one file and one word here per scheme.
using Scheme = std::variant<Generic, Enriched>;

/// The contraction operator of the two-stage algorithm,  B = I - omega P^-1 S,  with
///   S = X_epsilon on the contacts Stage 1 works with (the law), P = X_eta on all contacts (the scheme).
/// All six matrices of [ADI12] are this one:
///   B_eps (10): P = X_inf        B_eps,eta (20): P = X_eta      (S = X_eps on all contacts)
///   B_0 (25): S = X_0            B_0,eta: S = X_0, P = X_eta
///   B-bar (31): S = X_0 on the active contacts, P = X_inf       B-bar_eta (34): the same with P = X_eta
/// since Y_eps = X - X_eps, Y_eps,eta = X_eta - X_eps by the Woodbury identity.
struct Contraction {
  InterfaceOperator preconditioner;  ///< P, positive definite
  InterfaceOperator system;          ///< S, positive semidefinite
  double relaxation = 1.0;           ///< omega of F <- F + omega (F' - F); 1 is the paper's algorithm
  /// schwarz: of resultants p, see schwarz_contraction; rows are copies.
  DecompositionScheme scheme = DecompositionScheme::nscdd;

  Index rows() const { return system.rows(); }
  Index cols() const { return system.rows(); }
  bool schwarz() const { return scheme == DecompositionScheme::schwarz; }
  Vector apply(const Vector& f) const;
};

/// The iteration of the scheme schwarz with a linear law: block Jacobi on W + epsilon,
///     J = I - omega (D + epsilon)^-1 (W + epsilon),    W = H^T M^-1 H,    D = blockdiag_E(H_E^T M^-1 H_E)
/// with whole masses. Its eigenvalues other than 1 - omega are those of a map of the resultants p_E = N_E H_E r_E on
/// the copies of shared grains, p' = (1 - omega) p - omega (o - M_b F o), where o are the sums of the p of the other
/// copies, F = N_E (M_E + K_E / epsilon)^-1 N_E^T of each subdomain is the `system`, and M_b^-1 the `preconditioner`.
/// `parts`: of nscdd, with the contacts of the iteration.
Contraction schwarz_contraction(const Decomposition& parts, const Law& law);

/// Flexibility of the network that Stage 2 of a scheme sees.
inline double flexibility(const Scheme& scheme) {
  return std::visit([](const auto& one) { return one.flexibility(); }, scheme);
}

/// The contraction operator of a scheme with a linear law on every contact.
inline Contraction contraction(const Decomposition& parts, const Scheme& scheme, const Law& law) {
  const InterfaceFamily family(parts);
  return {family.at(flexibility(scheme)), family.at(flexibility(law))};
}

/// The same with Stage 1 on the active contacts only (G_E) and Stage 2 on all (H_E). At epsilon = 0 this is the local
/// analysis of [ADI12] sections 4.3 and 4.4. `active`: one flag per contact of the packing.
inline Contraction contraction(const Decomposition& parts, const Scheme& scheme, const Law& law,
                               const std::vector<char>& active) {
  return {InterfaceFamily(parts).at(flexibility(scheme)),
          InterfaceFamily(restrict_contacts(parts, active)).at(flexibility(law))};
}

}  // namespace nscdd
