// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {

/// Result of `largest_margin`.
struct LargestMargin {
  Vector velocities;  ///< v', m/s, or y, N s, with the largest margin found
  Vector impulses;    ///< lambda_n of the last iterate; they add up to 1 at most
  Vector slack;       ///< u_n - s of the last iterate, over max |q_c|
  double speed = 0;   ///< Verdict::speed of `velocities`, m/s
  Index factorisations = 0;
};

/// max |q_c| of a problem with contacts, or 1 if q = 0.
double speed_scale(const LocalFrictionProblem& problem);

/// Maximises the margin: s - (delta/2) |v'|^2 subject to u - s a_c e_n in K* = {u_n >= mu |u_t|} at every contact, with
/// the weights a_c > 0, and s <= max |q_c|; u = H^T v' + q, or W y + q without M and H. Its dual minimises
///     q^T lambda + tau max |q_c| + |H lambda|^2 / (2 delta),   lambda in K,   sum a_c lambda_n + tau = 1.
/// Mehrotra's predictor and corrector with the scaling of Nesterov and Todd; delta falls with the complementarity, so
/// that v' tends to the slowest velocities of the largest margin, and H lambda to zero.
LargestMargin largest_margin(const LocalFrictionProblem& problem, const Vector& friction, const Vector& weights,
                             const Monitor& monitor);

}  // namespace nscdd
