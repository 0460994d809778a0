// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Seidel sweeps with momentum. After a sweep S, impulses move on by a part of their last change,
//     r' = S(y_k),   y_{k+1} = r' + beta (r' - r),
// so that a slow mode, which a sweep multiplies by 1 - d, falls by 1 - d / (1 - beta) per sweep. Coulomb's law has no
// potential: momentum keeps a few contacts in motion. So sweeps without momentum end each turn and let these contacts
// settle before the residual is taken. Beta rises after a turn that made progress, and falls after one that did not.
#pragma once

#include "contact_solvers/nlgs.hpp"

namespace nscdd {

/// Turns of sweeps until the run is over or `most` sweeps are done. Returns whether it is over.
template <ContactProblem P>
bool accelerated_sweeps(P& problem, SolverRun<P::dimension>& run, Index most) {
  constexpr double first_lag = 0.1, least_lag = 0.02, largest_lag = 0.5;      // 1 - beta
  constexpr double with_momentum = 40, without = 10;                          // sweeps of a turn times the lag
  constexpr double first_part = 1.0 / 64;                                     // of a turn: the next ones double it
  constexpr double progress = 0.95, faster = 0.9, slower = 1.3, worse = 100;  // of the residual, and of the lag
  constexpr Index patience = 60;                                              // turns
  FrictionSolverOptions options = run.options;
  options.relaxation = std::min(1.0, options.relaxation);  // momentum takes the place of over-relaxation
  const auto sweeps = problem.sweeps(options);
  const OneBlasThread serial_blas;
  const Index end = std::min(run.options.maximum_sweeps, run.now.sweeps + most);
  Vector impulses = run.now.impulses;
  StallWatch<P::dimension> watch(run, patience);
  double lag = first_lag, last = infinity, part = first_part;
  const auto sweeps_for = [&](double share) { return static_cast<Index>(std::ceil(part * share / lag)); };
  const auto go = [&](Index many, double momentum) {
    impulses = sweeps(impulses, SweepTurn{run.now.sweeps, many, momentum});
    run.now.sweeps += many;
    run.now.operations += static_cast<double>(many) * run.data.product_operations;
  };
  for (;;) {
    if (run.judge(impulses) || watch.ends(run)) return true;
    if (run.now.sweeps >= end) return false;
    const double residual = run.now.state.residual;
    if (part == 1)
      lag = residual < progress * last ? std::max(least_lag, faster * lag) : std::min(largest_lag, slower * lag);
    if (residual > worse * last) impulses = run.best().impulses;
    last = run.now.state.residual;
    const Index left = end - run.now.sweeps, plain = std::min(left, sweeps_for(without));
    go(std::min(left - plain, sweeps_for(with_momentum)), 1 - lag);
    go(plain, 0);
    part = std::min(1.0, 2 * part);
  }
}

template <ContactProblem P>
void accelerated(P& problem, SolverRun<P::dimension>& run) {
  accelerated_sweeps(problem, run, run.options.maximum_sweeps);
}

}  // namespace nscdd
