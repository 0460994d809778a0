// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

#include <vector>

namespace nscdd {

/// Impulses of the linear rigid problem under the arriving velocities.
struct RigidImpulses {
  Vector impulses;      ///< r, kg m/s; the least-norm solution where `unique` is false
  bool unique = true;   ///< false for a hyperstatic network (W singular)
  double residual = 0;  ///< ||W r + H^T V^-|| / ||H^T V^-||, 0 for a zero right-hand side
};

/// Contacts up to which `rigid_impulses` works densely.
inline constexpr Index dense_impulse_limit = 4000;

/// Solves  W r = -H^T V^-,  W = H^T M^-1 H: contacts that neither open nor close, in tension or compression.
/// It is the least-squares problem min || M^-1/2 H r + M^1/2 V^- ||, least norm among its solutions.
/// Dense complete orthogonal decomposition up to `dense_impulse_limit`; above, preconditioned conjugate
/// gradients from zero, which may stop short: see the residual.
RigidImpulses rigid_impulses(const ReferenceProblem& problem);

/// The active contacts by the paper's rule ([ADI12] section 4.3): those in compression, r > 0. An impulse
/// within 1e-10 of the largest counts as zero, hence inactive. One flag per contact.
/// Throws Error where no grain has an arriving velocity; one that loads no contact leaves none active.
std::vector<char> active_contacts(const ReferenceProblem& problem, const RigidImpulses& rigid);

}  // namespace nscdd
