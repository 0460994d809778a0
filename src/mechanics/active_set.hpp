// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

#include <vector>

namespace nscdd {

/// Impulses of the linear rigid problem under the arriving velocities.
struct RigidImpulses {
  Vector impulses;      ///< r, kg m/s; if `unique` is false, the solution of least norm
  bool unique = true;   ///< false for a hyperstatic network (W singular)
  double residual = 0;  ///< ||W r + H^T V^-|| / ||H^T V^-||, 0 for a zero right-hand side
};

/// Contacts up to which `rigid_impulses` works densely.
inline constexpr Index dense_impulse_limit = 4000;

/// Solves  W r = -H^T V^-,  W = H^T M^-1 H: contacts neither open nor close, and may be in tension. This is
/// the least-squares problem min || M^-1/2 H r + M^1/2 V^- ||; of its solutions the one of least norm is
/// returned. Up to `dense_impulse_limit` contacts it is found by a dense complete orthogonal decomposition,
/// above by preconditioned conjugate gradients from zero. These may stop short: see the residual.
RigidImpulses rigid_impulses(const ReferenceProblem& problem);

/// The active contacts by the paper's rule ([ADI12] section 4.3): those in compression, r > 0. One flag per
/// contact. An impulse of at most 1e-10 times the largest one counts as zero, so its contact is inactive.
/// Throws Error if no grain has an arriving velocity. If the velocities load no contact, no contact is
/// active.
std::vector<char> active_contacts(const ReferenceProblem& problem, const RigidImpulses& rigid);

}  // namespace nscdd
