// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"

namespace nscdd {

/// Observed convergence of Algorithm 1 next to the solution of a step, compared with the local theory.
struct RateAtSolution {
  StepReport report;                       ///< of the contact solver that found the solution
  double drift = not_a_number;             ///< |V_1 - V| / |V| of one iteration from the solution
  Index active = 0, stick = 0, slide = 0;  ///< contacts by their statuses at the solution
  double margin = not_a_number;            ///< the smallest status_margin over the root mean square of |r_c|
  Index near_edge = 0;                     ///< contacts whose margin is at most 1e-6
  double predicted = not_a_number;         ///< radius of the frozen iteration with n_GS sweeps
  bool complex_pair = false;               ///< its dominant eigenvalue is one of a pair
  double predicted_exact = not_a_number;   ///< radius with an exact Stage 1; NaN above dense_rate_grains
  double observed = not_a_number;          ///< factor per iteration; NaN if a status changed
  double observed_error = not_a_number;    ///< its change over the last tenth of the run
  Index modes = 0;                         ///< of the observation, 1 or 2
  Index iterations = 0, changed = 0;       ///< run; of them those in which a contact had another status
  bool converged = false;                  ///< solution and prediction are, and `observed` is known

  bool known() const { return converged; }
};

/// Finds the solution of the next step, and the rate at which Algorithm 1 returns to it or, if its frozen map is
/// unstable, leaves it (docs/theory.md, section 9).
/// 1. Solve the contact problem of the whole packing by `auto` to rounding; a natural map above 1e-10 is no solution.
/// 2. Cut it, see restart_at: z = (r, F) is a fixed point of Algorithm 1, generic or enriched, with any n_GS.
/// 3. Perturb F by 1e-6 |F| in a random direction and run `maximum_iterations` of the algorithm, in a hundred parts.
///    Each begins at z + d, with d the error after the last one, scaled to a fixed size of the velocities. (The change
///    of z by the same iterations is subtracted.) Without a change of status this is one long run without rounding.
/// 4. The rate is that of the sizes over the last tenth; or that of two modes, which may be a pair, if the errors of
///    three tenths follow e_2 = a e_1 + b e_0: the one that has changed less since the tenth before.
/// Throws Error as require_comparable and prepare_solution.
RateAtSolution rate_at_solution(const Simulation& simulation);

/// The distance of a contact from another status, N s: with the impulse s that would stop it, r_n = max(0, s_n) and r_t
/// is s_t clamped to friction r_n, so it is that of the nearer corner, s_n = 0 or |s_t| = friction s_n.
template <int D>
double status_margin(const ContactLaw& law, const GrainContact<D>& contact, GrainVelocities<D> velocities) {
  const LocalVector<D> stop = stopping_impulse<D>(contact, velocities);
  const double n = stop.n + contact.pull;
  const bool rubs = contact.friction > 0 && std::visit([](const auto& one) { return one.rubs; }, law);
  if (n <= 0) return -n;
  return rubs ? std::min(n, std::abs(contact.friction * n - norm(stop.t))) : n;
}

/// Takes Algorithm 1 to the impulses of solved contacts, step 2 above; returns its state.
template <int D>
Vector restart_at(GranularTwoStage<D>& iteration, const std::vector<GrainContact<D>>& solved) {
  const Index unknowns = iteration.parts().interface_size();
  Vector z = Vector::Zero(D * count(solved) + unknowns);
  for (Index c = 0; c < count(solved); ++c) set_component<D>(z, c, solved[at(c)].impulse);
  iteration.restart(z);
  z.tail(unknowns) = iteration.parts().generic_interface_solve(iteration.parts().interface_jumps());
  iteration.restart(z);
  return z;
}

}  // namespace nscdd
