// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/rigid_motions.hpp"
#include "linalg/multifrontal/factor.hpp"
#include "linalg/range_projector.hpp"
#include "linalg/sparse_cholesky.hpp"
#include <nscdd/ddm/decomposition.hpp>

#include <mutex>

namespace nscdd {

/// A value that is computed when it is first asked for: once, however many threads ask.
template <class T>
class Lazy {
 public:
  template <class Make>
  const T& get(Make&& make) const {
    std::call_once(once_, [&] { value_.emplace(make()); });
    return *value_;
  }

 private:
  mutable std::once_flag once_;
  mutable std::optional<T> value_;
};

/// Every M_{E,eta} of one subdomain, for a sweep along eta: what does not depend on eta.
/// Small subdomains are diagonalised once, M_E^-1/2 K_E M_E^-1/2 = Q Lambda Q^T. After that each eta costs
/// one scaling: the weights eta / (eta + lambda) run from 1 (eta = infinity) to the indicator of lambda = 0.
/// The rank of H_E tells how many eigenvalues are zero (`sparse_rank`, which does not depend on masses).
/// Large subdomains keep the pattern of their sparse Cholesky factor; only its numbers are computed again.
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
    double tilt;         // the largest singular value of M^-1/2 H that counts as zero over the smallest that does not
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

/// M_{E,eta} = M_E + K_E / eta, K_E = H_E H_E^T ([ADI12] eqs. (23), (24)), ready to be inverted.
/// eta = infinity is M_E; eta = 0 is the rigid limit, whose "inverse" is
///     M_E^inf = M_E^-1/2 (I - Pi) M_E^-1/2,   Pi the projector onto range(M_E^-1/2 H_E)
/// ([ADI12] eq. (26)). It exists for every network, also for hyperstatic ones. With the motions Z of rigid clusters it
/// is Z times the same of Z^T M_E Z and Z^T H_E times Z^T.
class EnrichedInertia {
 public:
  /// The family must outlive it. Throws Error unless eta is in [0, infinity].
  EnrichedInertia(const EnrichedInertiaFamily& family, double eta);

  /// M_{E,eta}^-1 R (eta = 0: M_E^inf R). R: impulses on the grains, d n_E; result: velocities.
  /// All NaN if M_{E,eta} is not positive definite in double precision.
  Vector solve(const Vector& impulses) const;

  /// A_E M_{E,eta}^-1 A_E^T on the interface rows that touch E, in the order of the family's `rows`.
  Matrix condense() const;

  /// In the rigid limit: how far Pi may be off, because singular values count as zero that are not (RangeProjector).
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

/// An upper bound of the eigenvalues of all M_E^-1 K_E, 1/kg: with A = M_E^-1/2 H_E,
/// ||A^T A||_2 <= || |A|^T |A| ||_infinity. 0 without contacts.
double stiffest(const Decomposition& parts);

}  // namespace nscdd
