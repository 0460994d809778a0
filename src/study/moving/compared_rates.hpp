// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"
#include "two_stage/frozen_iteration.hpp"

namespace nscdd {

/// Observed convergence of Algorithm 1 in a step, compared with the local theory.
struct ComparedRate {
  StepReport report = {};
  Index active = 0, stick = 0, slide = 0;  ///< contacts by the statuses compared
  double predicted = not_a_number;         ///< radius of the frozen iteration with n_GS sweeps
  double predicted_exact = not_a_number;   ///< the same with an exact Stage 1; NaN above dense_rate_grains
  bool complex_pair = false;               ///< the dominant eigenvalue of `predicted` is one of a pair
  bool converged = false;                  ///< of the prediction
  double observed = not_a_number;          ///< factor per iteration; NaN if none is found
  double observed_error = not_a_number;

  bool known() const { return converged && !std::isnan(observed); }  ///< prediction and observation both
  /// |observed - predicted| / |1 - predicted|, the relative error of the number of iterations to come. NaN for NaN.
  double relative_gap() const {
    return observed == predicted ? 0.0 : std::abs((observed - predicted) / (1 - predicted));
  }
  /// Whether that gap is at most 1 %, or the rates differ by at most three times the error.
  bool agree() const { return relative_gap() <= 0.01 || std::abs(observed - predicted) <= 3 * observed_error; }
};

/// Largest number of grains for which the rate with an exact Stage 1, by dense matrices, is computed.
inline constexpr Index dense_rate_grains = 1500;

/// Counts the statuses, and predicts the rate at them. `power`: see frozen_radius.
template <int D>
void predict(ComparedRate& rate, const Simulation& simulation, const GranularDecomposition<D>& parts,
             const std::vector<ContactStatus>& statuses, const std::vector<FrozenContact<D>>& frozen,
             const std::optional<InterfaceOperator>& enriched, Index power = 1) {
  const StepSolver& solver = simulation.dynamics.solver;
  rate.active = count(statuses) - std::ranges::count(statuses, ContactStatus::open);
  rate.stick = std::ranges::count(statuses, ContactStatus::stick);
  rate.slide = rate.active - rate.stick;
  const FrozenIteration<D> iteration(parts, frozen, solver.gauss_seidel_sweeps, enriched, solver.interface_relaxation);
  const MapRadius radius = frozen_radius(iteration, power);
  rate.predicted = radius.value;
  rate.complex_pair = radius.dominant.imag() > 0;
  rate.converged = radius.converged;
  if (simulation.system.grains() <= dense_rate_grains)
    rate.predicted_exact =
        frozen_radius(frozen_contraction(parts, frozen, enriched, solver.interface_relaxation)).value;
}

/// The `report` of the run is without the results of its end; the error is that of the fit plus drift along it.
struct PredictedObserved : ComparedRate {
  double rate_z = not_a_number;  ///< factor per iteration of Z itself over the stretch fitted
  Index first = 0, last = 0;     ///< iterations of the stretch fitted
};

/// Runs the iterations of the next step of a simulation to their end, and compares their rate with the local theory
/// (docs/theory.md, section 9). The rate is fitted to |F_i - 2 F_{i-1} + F_{i-2}| over the last half of the stretch of
/// iterations without a change of status in which it fell or grew most: with friction a frozen map may be unstable, and
/// the run then leaves these statuses. The prediction is of the statuses of the stretch; in space, where directions of
/// sliding turn, of its last iteration. Throws Error as require_comparable.
PredictedObserved predicted_observed(const Simulation& simulation);

/// Throws Error naming the key for settings without a predicted rate: no interface, conjugate gradients, enrichment
/// other than of every iteration, relaxed contacts, a viscous law.
void require_comparable(const Dynamics& dynamics, const Partitioner& partitioner);

/// `report`: of the contact solver that found the solution. The error: change of the observed rate in the last tenth.
struct RateAtSolution : ComparedRate {
  double drift = not_a_number;        ///< |V_1 - V| / |V| of one iteration from the solution
  double margin = not_a_number;       ///< the smallest status_margin over the root mean square of |r_c|
  Index near_edge = 0;                ///< contacts whose margin is at most 1e-6
  Index modes = 0;                    ///< of the observation, 1 or 2
  Index iterations = 0, changed = 0;  ///< run; of them those in which a contact had another status
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
double status_margin(const ContactLaw& law, const GrainContact<D>& contact, GrainVelocities<D> velocities);

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
