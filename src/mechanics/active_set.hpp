// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/reference_problem.hpp>

namespace nscdd {

/// Impulses of the linear rigid problem under the arriving velocities.
struct RigidImpulses {
  Vector impulses;      ///< r, kg m/s; if `unique` is false, the solution of least norm
  bool unique = true;   ///< false for a hyperstatic network (W singular)
  double residual = 0;  ///< ||W r + H^T V^-|| / ||H^T V^-||, 0 for a zero right-hand side
};

inline constexpr Index dense_impulse_limit = 4000;  ///< most contacts for which `rigid_impulses` works densely

/// Solves  W r = -H^T V^-,  W = H^T M^-1 H: contacts neither open nor close, and may be in tension. Returns the
/// solution of least norm of min || M^-1/2 H r + M^1/2 V^- ||: up to `dense_impulse_limit` contacts by a dense complete
/// orthogonal decomposition, above by preconditioned conjugate gradients, which may stop early: see the residual.
RigidImpulses rigid_impulses(const ReferenceProblem& problem);

/// Flags of active contacts by [ADI12] section 4.3: r > 1e-10 max |r|. Throws Error if no grain has a velocity.
std::vector<char> active_contacts(const ReferenceProblem& problem, const RigidImpulses& rigid);

struct UnilateralOptions {
  double tolerance = 1e-8;  ///< on the residual, see UnilateralImpulses
  Index maximum_iterations = 200;
};

enum class UnilateralStatus : char {
  open,      ///< w > 0: separates
  idle,      ///< r = 0 and w = 0, both within the tolerance: weakly active
  carrying,  ///< r > 0
};

/// Impulses and velocities after a frictionless impact without restitution.
struct UnilateralImpulses {
  Vector impulses;    ///< r >= 0, kg m/s, one per contact
  Vector velocities;  ///< V = V^- + M^-1 H r, d n entries, m/s
  Vector separation;  ///< w = H^T V, one per contact, m/s
  std::vector<UnilateralStatus> status;
  double residual = 0;    ///< max |min(r_i sqrt(W_ii), w_i / sqrt(W_ii))| / max (|b_i| / sqrt(W_ii))
  Index iterations = 0;   ///< factorisations
  bool converged = true;  ///< residual <= tolerance

  Index count(UnilateralStatus wanted) const { return std::ranges::count(status, wanted); }
};

/// Solves the frictionless Signorini conditions in velocities, of every contact at once:
///     r >= 0,   w = W r + b >= 0,   r^T w = 0,      W = H^T M^-1 H,   b = H^T V^-,
/// which is  V = argmin 1/2 (V - V^-)^T M (V - V^-)  subject to  H^T V >= 0. V and w are unique; r is not if W is
/// singular on the contacts that stay closed. A contact carries if r_i sqrt(W_ii), and opens if w_i / sqrt(W_ii), both
/// in sqrt(kg) m/s, exceeds tolerance x the largest |b_i| / sqrt(W_ii). A network without compression has r = 0 and
/// residual 0. The method is an interior point method, which never forms W; see `converged`.
UnilateralImpulses unilateral_impulses(const ReferenceProblem& problem, const UnilateralOptions& options = {},
                                       const Monitor& monitor = {});

}  // namespace nscdd
