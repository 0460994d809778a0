// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/decomposition.hpp>
#include <nscdd/linalg/inertia_factor.hpp>

namespace nscdd {

struct KernelSplit;  // linalg/pencil.hpp, beside its source

/// The interface operator  X_eta = sum_E A_E (M_E + K_E / eta)^-1 A_E^T  ([ADI12] eq. (17)), n_Gamma x n_Gamma, s.p.d.
/// for eta > 0: velocity jumps caused by interface impulses F_Gamma if contacts act as links of flexibility eta.
/// eta = infinity is the X of the generic algorithm. eta = 0 is the rigid limit, semidefinite; on restricted contacts
/// (G_E) it is the X-bar of the nonsmooth analysis.
class InterfaceOperator {
 public:
  double flexibility() const;  ///< 1/kg; eta, or the epsilon of the system of a Contraction
  const Decomposition& decomposition() const;
  const SparseMatrix& generic() const;  ///< X_infinity, nearly diagonal
  Index rows() const;
  Index cols() const { return rows(); }

  Vector apply(const Vector& f) const;  ///< X_eta F by one local solve per subdomain
  /// d f^T X_eta f / d log eta = sum_E V_E^T K_E V_E / eta with V_E = M_{E,eta}^-1 A_E^T f, one local solve per
  /// subdomain (Hellmann and Feynman). 0 for eta = infinity and in the rigid limit.
  double slope(const Vector& f) const;
  const Matrix& dense() const;  ///< X_eta, symmetric to the last bit; assembled once, then kept

  /// dim ker X_eta: 0 for eta > 0; in the rigid limit sum_E rank H_E - rank H, the self-stresses across the interface.
  Index nullity() const;
  /// False if these ranks are in doubt: a singular value is close to the tolerance of a rank, 10^-6 of the length of a
  /// column, or ranks contradict each other. Radii of the rigid limit then do not count as converged.
  bool nullity_is_clear() const;
  /// Error estimate of X_0 in the rigid limit, in units of X_infinity. Singular values of contacts that count as zero
  /// without being zero tilt the range of H_E. Where contacts depend on each other exactly, it is the rounding over the
  /// smallest singular value that counts. Infinity if `nullity_is_clear` is false; 0 for eta > 0.
  double uncertainty() const;

  /// The largest over the smallest inertia of a copy.
  double ratio_of_masses() const;

  /// Orthonormal bases of the kernel of D^-1/2 X_eta D^-1/2 and of its complement, D = diag(scale()). Computed once.
  const KernelSplit& kernel() const;

  /// X_eta^-1 g for eta > 0; for eta = infinity in closed form (Interface::solve_generic). A family with an
  /// InertiaMethod factorises the saddle point [M_{E,eta} A_E^T; A_E 0] once and solves on the interface only; ranks
  /// may share the factor, and g and the result are whole on each. Without a method, a solve with M + K/eta of the
  /// undivided packing finds copies with jumps g whose impulses balance on every grain. All NaN if X_eta is not
  /// positive definite in double precision. Throws Error for eta = 0, and on several processes without a method.
  Vector solve(const Vector& g) const;
  Vector solve_generic(const Vector& g) const;  ///< X_inf^-1 g

  /// diag(X_inf), the natural scale of every X_eta: 0 <= X_eta <= X_inf.
  const Vector& scale() const;

  class Implementation;
  explicit InterfaceOperator(std::shared_ptr<const Implementation> implementation);

 private:
  Vector solve_on_interface(const Vector& g) const;

  std::shared_ptr<const Implementation> implementation_;
};

/// Every X_eta of one decomposition; shares what does not depend on eta. Operators outlive the family.
class InterfaceFamily {
 public:
  /// Diagonalises subdomains of up to `dense_limit` unknowns, factorises others at each eta. `inertia`: see `solve`.
  explicit InterfaceFamily(const Decomposition& parts, Index dense_limit = default_dense_limit,
                           InertiaMethod inertia = {});
  static constexpr Index default_dense_limit = 300;
  InterfaceOperator at(double eta) const;  ///< eta in [0, infinity]; throws Error otherwise

  class Preparation;

 private:
  std::shared_ptr<const Preparation> preparation_;
};

}  // namespace nscdd
