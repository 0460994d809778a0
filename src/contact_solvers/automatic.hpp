// SPDX-License-Identifier: GPL-3.0-or-later
// Rounds of sweeps, then Newton's steps, then the curve of a smoothed law, each from the impulses of the sweeps.
// Later rounds sweep without momentum, and the last one from the first impulses: whether a curve leads to a solution
// depends on where it begins. Problems of very many contacts start with accelerated sweeps as long as these make
// progress: they come nearer to a solution than any point of the curve. Without friction an interior point method takes
// the place of the first Newton's steps. If given impulses fail, rounds from zero follow, which forget the best so far.
#pragma once

#include "contact_solvers/accelerated.hpp"
#include "contact_solvers/continuation.hpp"
#include "contact_solvers/interior_point.hpp"

namespace nscdd {

/// Whether sweeps update the velocities of bodies instead of reading rows of W. Problems without M and H are mostly
/// small: their first round has no momentum, and a check every ten sweeps.
template <ContactProblem P>
bool sweeps_are_cheap(const P& problem) {
  if constexpr (StoredProblem<P>)
    return problem.knows_bodies();
  else
    return true;
}

/// All rounds from the present impulses. Returns whether the run is over.
template <ContactProblem P>
bool rounds(P& problem, SolverRun<P::dimension>& run) {
  constexpr Index first_sweeps = 500, rounds_with_momentum = 2, very_many_contacts = 100'000;
  // Smoothings of the curve over the residual of the sweeps, for a run from zero and for one from given impulses.
  constexpr double cold_smoothings[] = {100, 10, 1000, 1}, warm_smoothings[] = {10, 100, 1, 1000};
  const FrictionSolverOptions& options = run.options;
  const auto& smoothings = run.data.sums.all_zero(run.now.impulses) ? cold_smoothings : warm_smoothings;
  const Vector begin = run.now.impulses;
  std::optional<FrictionStatus> given_up;  // how sweeps ended, once they make no progress
  const auto ends_run = [&] {              // not if they stalled: the other solvers are left
    given_up = run.now.status;
    if (*given_up != FrictionStatus::stalled && *given_up != FrictionStatus::diverged) return true;
    run.now.status = FrictionStatus::maximum_reached;
    run.go_back(run.best());
    return false;
  };
  // Only if W is stored: a divided problem goes to its linear systems sooner.
  if (StoredProblem<P> && run.data.contacts() >= very_many_contacts) {
    accelerated(problem, run);
    if (run.now.status != FrictionStatus::maximum_reached && ends_run()) return true;
    run.go_back(run.best());
  }
  constexpr Index last = std::ssize(cold_smoothings) - 1;
  for (Index turn = 0; turn <= last; ++turn) {
    const Index most = std::min(first_sweeps << 2 * turn, options.maximum_sweeps - run.now.sweeps);
    if (!given_up) {
      if (turn == last) run.now.impulses = begin;
      const bool accelerates = turn < rounds_with_momentum && (turn > 0 || sweeps_are_cheap(problem));
      if ((accelerates ? accelerated_sweeps(problem, run, most) : sweep(problem, run, most)) && ends_run()) return true;
    }
    if (run.spent()) continue;
    const FrictionSolution swept = run.now;
    if (turn == 0 && !run.data.sums.any(!run.data.friction.isZero(0))) {
      if (InteriorPointSteps<P>(problem, run).finish()) return true;
      run.go_back(swept);
    }
    if (NewtonSteps<P>(problem, run).finish()) return true;
    run.go_back(swept);
    if (follow_curve(problem, run, smoothings[turn] * swept.state.residual)) return true;
    run.go_back(run.best());
  }
  const bool limited = run.spent() || (run.now.sweeps >= options.maximum_sweeps && !given_up);
  run.now.status = limited ? FrictionStatus::maximum_reached : given_up.value_or(FrictionStatus::stalled);
  return false;
}

template <ContactProblem P>
void automatic(P& problem, SolverRun<P::dimension>& run) {
  run.keeps_half = !run.data.sums.all_zero(run.now.impulses);
  const bool over = rounds(problem, run);
  if (!std::exchange(run.keeps_half, false) || over || run.spent() || !run.best().credible) return;
  const FrictionSolution warm = run.best();
  run.begin_again();
  rounds(problem, run);
  run.keep_better(warm);
}

}  // namespace nscdd
