// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/rigid_motions.hpp"

#include <mutex>

namespace nscdd {

/// A value computed at its first use, once for all threads.
template <class T>
class Lazy {
 public:
  const T& get(auto&& make) const {
    std::call_once(once_, [&] { value_.emplace(make()); });
    return *value_;
  }

 private:
  mutable std::once_flag once_;
  mutable std::optional<T> value_;
};

/// Every M_{E,eta} of one subdomain: computes once what does not depend on eta. Small subdomains are diagonalised,
/// M_E^-1/2 K_E M_E^-1/2 = Q Lambda Q^T. Each eta then costs one scaling by the weights eta / (eta + lambda), from 1
/// (eta = infinity) to the indicator of lambda = 0. The rank of H_E, which does not depend on masses, gives the number
/// of zeros. Large subdomains keep the pattern of their sparse Cholesky factor.
class EnrichedInertiaFamily {
 public:
  /// Diagonalised up to `dense_limit` unknowns d n_E.
  EnrichedInertiaFamily(const Subdomain& subdomain, Index dense_limit);
  Index size() const { return inertia_.size(); }            ///< d n_E
  const std::vector<Index>& rows() const { return rows_; }  ///< rows of A_E that are not empty, ascending

 private:
  friend class EnrichedInertia;
  struct Modes {
    Matrix vectors;      // M^-1/2 Q
    Vector eigenvalues;  // Lambda
    Matrix traces;       // on the interface, A M^-1/2 Q
    double tilt;         // largest singular value of M^-1/2 H that counts as zero, over the smallest other
  };
  Modes diagonalised() const;
  SparseMatrix sum(double eta) const;  // M + K / eta
  std::vector<Index> glued_dofs() const;
  const SymmetricAnalysis& condensation() const;

  Vector inertia_;
  std::vector<Index> rows_;
  SparseMatrix h_, a_, stiffness_;  // a: A_E without its empty rows
  std::optional<Modes> modes_;
  Index dofs_per_grain_ = 0;
  Matrix centres_;
  Lazy<CholeskyAnalysis> analysis_;
  Lazy<SymmetricAnalysis> condensation_;
};

/// The inverse of M_{E,eta} = M_E + K_E / eta, K_E = H_E H_E^T ([ADI12] eqs. (23), (24)). eta = infinity is M_E.
/// eta = 0 is the rigid limit, whose "inverse" is
///     M_E^inf = M_E^-1/2 (I - Pi) M_E^-1/2,   Pi the projector onto range(M_E^-1/2 H_E)
/// ([ADI12] eq. (26)). It exists for every network, also for a hyperstatic one. With the motions Z of rigid clusters it
/// is Z (Z^T M_E Z)^-1/2 (I - Pi) (Z^T M_E Z)^-1/2 Z^T, Pi for Z^T H_E.
class EnrichedInertia {
 public:
  /// The family must outlive it. Throws Error unless eta is in [0, infinity].
  EnrichedInertia(const EnrichedInertiaFamily& family, double eta);

  /// M_{E,eta}^-1 R (eta = 0: M_E^inf R). R: impulses on the grains, d n_E; result: velocities.
  /// All NaN if M_{E,eta} is not positive definite in double precision.
  Vector solve(const Vector& impulses) const;

  /// A_E M_{E,eta}^-1 A_E^T on the interface rows that touch E, in the order of the family's `rows`.
  Matrix condense() const;

  /// Error estimate of Pi in the rigid limit: singular values that count as zero without being zero (RangeProjector).
  double uncertainty() const;

 private:
  struct RigidInverse {
    RigidMotions motions;
    RangeProjector range;
  };
  Matrix apply(const Matrix& r) const;
  const RigidInverse& rigid() const;

  const EnrichedInertiaFamily& family_;
  double eta_;
  Vector weights_;  // of the modes of a small subdomain
  Lazy<RigidInverse> rigid_;
  Lazy<SparseCholesky> cholesky_;
};

/// Bound of all eigenvalues of M_E^-1 K_E, 1/kg. With A = M_E^-1/2 H_E, ||A^T A||_2 <= || |A|^T |A| ||_infinity.
double stiffest(const Decomposition& parts);

}  // namespace nscdd
