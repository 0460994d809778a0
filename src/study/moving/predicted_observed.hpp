// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"

namespace nscdd {

/// |observed - predicted| / |1 - predicted|, the relative error of the number of iterations to come. NaN for NaN.
double relative_gap(double observed, double predicted);
/// Whether that gap is at most 1 %, or the rates differ by at most three times `error`.
bool rates_agree(double observed, double predicted, double error);

/// Observed convergence of a step, compared with the local theory.
struct PredictedObserved {
  StepReport report;                       ///< of the run, without the results of its end
  Index active = 0, stick = 0, slide = 0;  ///< at the statuses compared
  double predicted = not_a_number;         ///< radius of the frozen iteration with n_GS sweeps
  double predicted_exact = not_a_number;   ///< the same with an exact Stage 1; NaN above dense_rate_grains
  bool complex_pair = false;               ///< the dominant eigenvalue of `predicted` is one of a pair
  bool converged = false;                  ///< of the prediction
  double observed = not_a_number;          ///< factor per iteration; NaN if no stretch shows one
  double observed_error = not_a_number;    ///< standard error of the fit plus drift along it
  double rate_z = not_a_number;            ///< factor per iteration of Z itself over the stretch fitted
  Index first = 0, last = 0;               ///< iterations of the stretch fitted

  bool known() const { return converged && !std::isnan(observed); }  ///< prediction and observation both
  double relative_gap() const { return nscdd::relative_gap(observed, predicted); }
  bool agree() const { return rates_agree(observed, predicted, observed_error); }
};

/// Runs the iterations of the next step of a simulation to their end, and compares their rate with the local theory
/// (docs/theory.md, section 9). The rate is fitted to |F_i - 2 F_{i-1} + F_{i-2}| over the last half of the stretch of
/// iterations without a change of status in which it fell or grew most: with friction a frozen map may be unstable, and
/// the run then leaves these statuses. The prediction is of the statuses of the stretch; in space, where directions of
/// sliding turn, of its last iteration. Throws Error as require_comparable.
PredictedObserved predicted_observed(const Simulation& simulation);

/// Largest number of grains for which the rate with an exact Stage 1, by dense matrices, is computed.
inline constexpr Index dense_rate_grains = 1500;

/// Throws Error naming the key for settings without a predicted rate: no interface, conjugate gradients, enrichment
/// other than of every iteration, relaxed contacts, a viscous law.
void require_comparable(const Dynamics& dynamics, const Partitioner& partitioner);

}  // namespace nscdd
