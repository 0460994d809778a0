// SPDX-License-Identifier: GPL-3.0-or-later
// Nonlinear Gauss-Seidel (Jean and Moreau) on W: each contact in turn takes the impulse that solves its own problem of
// D components exactly while the others keep theirs, relaxed by omega.
#pragma once

#include "contact_solvers/solver_run.hpp"
#include "linalg/threads.hpp"

namespace nscdd {

/// Sweeps until the run is over or `most` sweeps are done. Returns whether it is over.
template <ContactProblem P>
bool sweep(P& problem, SolverRun<P::dimension>& run, Index most) {
  const FrictionSolverOptions& options = run.options;
  const auto sweeps = problem.sweeps(options);
  const OneBlasThread serial_blas;  // here, because switching it in each sweep is expensive
  Vector impulses = run.now.impulses;
  const Index end = run.now.sweeps + most;
  StallWatch<P::dimension> watch(run);
  for (;;) {
    if (run.judge(impulses) || watch.ends(run)) return true;
    if (run.now.sweeps >= end) return false;
    const Index many = std::min(options.check_every, end - run.now.sweeps);
    impulses = sweeps(impulses, SweepTurn{run.now.sweeps, many});
    run.now.sweeps += many;
    run.now.operations += static_cast<double>(many) * run.data.product_operations;
  }
}

template <ContactProblem P>
void nlgs(P& problem, SolverRun<P::dimension>& run) {
  sweep(problem, run, run.options.maximum_sweeps);
}

}  // namespace nscdd
