// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/ddm/decomposition.hpp>

#include <memory>
#include <vector>

namespace nscdd {

/// M_{E,eta} = M_E + K_E / eta, K_E = H_E H_E^T ([ADI12] eqs. (23), (24)), ready to be inverted.
/// eta = infinity is M_E; eta = 0 is the rigid limit, whose "inverse" is
///     M_E^inf = M_E^-1/2 (I - Pi) M_E^-1/2,   Pi the projector onto range(M_E^-1/2 H_E)
/// ([ADI12] eq. (26)). It exists for every network, also for hyperstatic ones.
class EnrichedInertia {
 public:
  /// M_{E,eta}^-1 R (eta = 0: M_E^inf R). R: impulses on the grains, d n_E; result: velocities.
  /// All NaN if M_{E,eta} is not positive definite in double precision.
  Vector solve(const Vector& impulses) const;

  /// A_E M_{E,eta}^-1 A_E^T on the interface rows that touch E, in the order of `interface_rows`.
  Matrix condense() const;

  class Implementation;
  explicit EnrichedInertia(std::shared_ptr<const Implementation> implementation);

 private:
  std::shared_ptr<const Implementation> implementation_;
};

/// Every M_{E,eta} of one subdomain, for a sweep along eta.
/// Small subdomains are diagonalised once, M_E^-1/2 K_E M_E^-1/2 = Q Lambda Q^T. After that each eta costs
/// one scaling: the weights eta / (eta + lambda) run from 1 (eta = infinity) to the indicator of lambda = 0.
/// The rank of H_E tells how many eigenvalues are zero (`sparse_rank`, which does not depend on masses).
/// Large subdomains keep the pattern of their sparse Cholesky factor; only its numbers are computed again.
class EnrichedInertiaFamily {
 public:
  /// Diagonalised up to `dense_limit` unknowns d n_E.
  EnrichedInertiaFamily(const Subdomain& subdomain, Index dense_limit);
  EnrichedInertia at(double eta) const;  ///< eta in [0, infinity]; throws Error otherwise

  class Preparation;

 private:
  std::shared_ptr<const Preparation> preparation_;
};

/// Rows of A_E that are not empty, ascending.
std::vector<Index> interface_rows(const Subdomain& subdomain);

}  // namespace nscdd
