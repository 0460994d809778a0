// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "two_stage/two_stage.hpp"
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// Convergence rate fitted to a run of the algorithm.
struct ObservedRate {
  double value = 0;  ///< factor by which the correction of F_Gamma shrinks per iteration
  double error = 0;  ///< of the fit: standard error plus remaining drift
  Index iterations = 0;
  bool converged = true;  ///< the error fell below the tolerance within the iterations allowed
};

/// Runs the two-stage iteration without loads from a random F_Gamma; errors of the linear problem obey the same
/// iteration. A line is fitted (GSL) to log || F_{i+1} - F_i ||_P, P = X_eta (schwarz: || r_{i+1} - r_i ||_{D +
/// epsilon}), over the last sixth of the run. With an exact Stage 1 the ratio of successive corrections rises to the
/// radius in that norm and never exceeds it. The run doubles up to `maximum_iterations` or a fit to `tolerance`.
ObservedRate observed_rate(const TwoStageIteration& iteration, const InterfaceOperator& preconditioner,
                           std::uint64_t seed, Index maximum_iterations = 20000, double tolerance = 1e-9);

/// The observed and the predicted rate at a point of a sweep.
struct ObservedResult {
  SweepResult predicted;
  ObservedRate observed;
  std::uint64_t seed = 1;  ///< of the random first F_Gamma

  double difference() const { return observed.value - predicted.radius.subdominant; }
  bool agree() const;  ///< the difference is within the error of the fit and the residual of the prediction
  bool converged() const { return observed.converged && predicted.radius.converged; }
};

/// Observed and predicted rate at every point of a sweep from point `first` on. Returns how many did not converge.
Index observe(const Model& model, const SweepParameters& parameters, std::uint64_t seed,
              const Sink<ObservedResult>& sink, const Monitor& monitor = {}, Index first = 0);

}  // namespace nscdd
