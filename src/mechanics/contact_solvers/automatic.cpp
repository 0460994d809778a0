// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps, Newton's steps and the central path in turns. None of them is sure: sweeps slow down, statuses cycle, and the
// path turns where it begins too far away. Each turn begins nearer to a solution, or elsewhere.
#include "mechanics/contact_solvers/contact_solver.hpp"

namespace nscdd {
namespace {

constexpr Index first_sweeps = 500;
// Of the path, over the residual of the sweeps. Where it is easy to get lost no value is the best one.
constexpr double gaps[] = {100, 1000, 10, 1, 300, 30, 3, 0.1};
constexpr double cold_gap = 3;  // of the path from unit impulses

}  // namespace

void automatic(SolverRun& run) {
  const FrictionSolverOptions& options = run.options;
  std::optional<Couplings> w;
  std::optional<FrictionStatus> given_up;  // how sweeps ended, once they are of no more use
  for (Index turn = 0; turn < std::ssize(gaps); ++turn) {
    const Index most = std::min(first_sweeps << turn, options.maximum_sweeps - run.now.sweeps);
    if (!given_up && sweep(run, most)) {
      given_up = run.now.status;
      if (*given_up != FrictionStatus::stalled && *given_up != FrictionStatus::diverged) return;
      run.now.status = FrictionStatus::maximum_reached;
      run.go_back(run.best());
    }
    if (run.spent()) continue;
    if (!w) w.emplace(run.problem, run.linear);
    const FrictionSolution swept = run.now;
    if (finish_by_newton(run, *w)) return;
    run.go_back(swept);
    if (follow_path(run, *w, gaps[turn] * swept.state.residual)) return;
    // Further sweeps cost more than a second path, which begins where all contacts are alike.
    if (turn == 0 && (run.judge(Vector::Zero(swept.impulses.size())) || follow_path(run, *w, cold_gap))) return;
    run.go_back(run.best());
  }
  const bool limited = run.spent() || (run.now.sweeps >= options.maximum_sweeps && !given_up);
  run.now.status = limited ? FrictionStatus::maximum_reached : given_up.value_or(FrictionStatus::stalled);
}

}  // namespace nscdd
