// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

#include <optional>
#include <vector>

namespace nscdd {

/// How the unilateral problem is solved.
enum class UnilateralMethod {
  interior_point,       ///< `project_on_cone`: tens of sparse factorisations, the set is unique
  projected_gradients,  ///< `minimize_nonnegative`: products with W only, slow on large packings
};

struct UnilateralOptions {
  UnilateralMethod method = UnilateralMethod::interior_point;
  double tolerance = 1e-8;                       ///< on the residual, see UnilateralImpulses
  std::optional<Index> maximum_iterations = {};  ///< if empty, that of the method
};

/// What a contact does in a frictionless impact.
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
  Index iterations = 0;   ///< factorisations or products with W, depending on the method
  bool converged = true;  ///< residual <= tolerance

  Index count(UnilateralStatus wanted) const;
};

/// Solves the frictionless Signorini conditions in velocities, of every contact at once:
///     r >= 0,   w = W r + b >= 0,   r^T w = 0,      W = H^T M^-1 H,   b = H^T V^-,
/// which is  V = argmin 1/2 (V - V^-)^T M (V - V^-)  subject to  H^T V >= 0. V and w are unique; r is not
/// if W is singular on the contacts that stay closed. Methods, residual and status work with r_i sqrt(W_ii)
/// and w_i / sqrt(W_ii), both in sqrt(kg) m/s: a contact carries if the first, and opens if the second,
/// exceeds tolerance x the largest |b_i| / sqrt(W_ii). A network that nothing compresses has r = 0 and
/// residual 0. W is never formed. Unlike in `rigid_impulses`, no contact pulls. If the method does not
/// converge, or a monitor stops it, the result says so.
UnilateralImpulses unilateral_impulses(const ReferenceProblem& problem, const UnilateralOptions& options = {},
                                       const Monitor& monitor = {});

}  // namespace nscdd
