// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps, Newton's steps and the central path in turns. None of them is sure: sweeps slow down, statuses cycle, and the
// path turns where it begins too far away. Each turn begins nearer to a solution, or elsewhere.
#include "mechanics/contact_solvers/contact_solver.hpp"

namespace nscdd {
namespace {

constexpr Index first_sweeps = 2000, turns = 8;
constexpr double gaps[] = {100, 10, 1, 0.1};  // over the residual of the sweeps

}  // namespace

void automatic(SolverRun& run) {
  const FrictionSolverOptions& options = run.options;
  std::optional<Couplings> w;
  bool stalled = false;
  for (Index turn = 0; turn < turns; ++turn) {
    const Index most = std::min(first_sweeps << turn, options.maximum_sweeps - run.now.sweeps);
    if (!stalled && sweep(run, most)) {
      stalled = run.now.status == FrictionStatus::stalled;
      if (!stalled) return;
    }
    if (run.spent()) continue;
    if (!w) w = couplings(run.problem);
    const FrictionSolution swept = run.now;
    if (finish_by_newton(run, *w)) return;
    run.now.impulses = swept.impulses;
    if (follow_path(run, *w, gaps[turn % std::ssize(gaps)] * swept.state.residual)) return;
    const FrictionSolution best = run.best();
    run.now.impulses = best.state.residual < swept.state.residual ? best.impulses : swept.impulses;
  }
  run.now.status = stalled ? FrictionStatus::stalled : FrictionStatus::maximum_reached;
}

}  // namespace nscdd
