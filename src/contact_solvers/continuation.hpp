// SPDX-License-Identifier: GPL-3.0-or-later
// Steps along the curve of a smoothed contact law, see smoothed_curve.hpp, and Newton's steps from its end.
#pragma once

#include "contact_solvers/newton.hpp"
#include "contact_solvers/smoothed_curve.hpp"

namespace nscdd {

/// Judges the impulses of a point of the curve. Returns whether the run is over.
template <int D>
bool judge_point(SolverRun<D>& run, const Vector& impulses, double length) {
  if (!run.judge(impulses, {.length = length})) return false;
  if (run.now.status != FrictionStatus::converged) return true;
  const FrictionSolution smooth = run.now;  // no contact is open or slides while t > 0
  if (!run.judge(run.projected()) || run.now.status != FrictionStatus::converged) run.now = smooth;
  return true;
}

/// Steps along a curve, and retreats where a step has lost it.
template <ContactProblem P>
struct CurveWalk {
  static constexpr double first_length = 0.5;  // of steps, in log t
  static constexpr double growth = 4, shrinking = 0.7, retreat = 0.3, least_length = 1e-5;
  static constexpr Index most_trials = 10;         // of a step
  static constexpr double largest_change = 5;      // of a component of z in a step, in units of sqrt(z^2 + 4 t)
  static constexpr double largest_residual = 0.2;  // after a step, likewise
  // Of Newton's step to the curve, likewise: above `lost` it is not taken, up to `near_curve` it is taken together with
  // the next step along the curve, and up to `on_curve` the point is one to retreat to.
  static constexpr double lost = 100, near_curve = 30, on_curve = 0.1;
  static constexpr double contraction = 0.6;  // wanted of Newton's steps to the curve
  static constexpr Index calm_steps = 4;      // after a retreat, which begin on the curve

  const SmoothedCurve<P>& curve;
  SmoothedPoint point;
  Vector impulses = {};                     // there
  std::optional<SmoothedCourse> safe = {};  // at the last point on the curve
  Index corrections = 0, calm = calm_steps;
  double taken = 0, length = first_length;  // of the last step; bounds the next one
  double last_off = infinity;

  bool lost_at(const std::optional<SmoothedCourse>& here) const {
    return !here || !(here->off <= (corrections > 0 ? std::min(lost, contraction * last_off) : lost));
  }
  bool go_back() {
    if (!safe || safe->length < least_length) return false;
    length = safe->length *= retreat;
    move(*safe, length);
    corrections = calm = 0;
    return true;
  }
  bool correct(const SmoothedCourse& here) {
    last_off = here.off;
    if (here.off <= (calm < calm_steps ? on_curve : near_curve)) return false;
    ++corrections;
    move(here, 0);
    return true;
  }
  void go_on(const SolverRun<P::dimension>& run, SmoothedCourse here) {
    corrections = 0;
    ++calm;
    const double longest = std::min(largest_change / here.steepest, growth * length);
    bool fits = false;
    for (Index trial = 0; trial < most_trials && !fits; ++trial) {
      taken = trial == 0 ? longest : shrinking * taken;
      move(here, taken);
      fits = curve.residual(point, impulses) <= largest_residual && run.plausible(impulses);
    }
    // If none fits, it is mostly because of the correction, which no shorter step changes.
    length = fits ? taken : retreat * longest;
    here.length = taken;
    if (!safe || here.off <= on_curve) safe = std::move(here);
  }
  void move(const SmoothedCourse& from, double by) {
    point = SmoothedCurve<P>::ahead(from, by);
    impulses = curve.impulses(point);
  }
};

/// Follows the curve of a smoothed contact law from the present impulses (from equal ones if these nearly vanish).
/// `relative_smoothing`: the first t over their mean square. Returns whether the run is over.
template <ContactProblem P>
bool follow_curve(P& problem, SolverRun<P::dimension>& run, double relative_smoothing) {
  constexpr Index most_factorisations = 220;
  constexpr double least_smoothing = 1e-32;  // smallest t relative to its first value; below it rounding dominates
  constexpr double newton_from = 1e-4;       // residual at which Newton's method is tried first
  constexpr double newton_after = 0.1;       // residual over that of the last trial, at which it is tried again
  if (run.data.sums.all_zero(run.data.q)) return run.judge(Vector::Zero(run.now.impulses.size()));
  SmoothedCurve<P> curve(problem, run, relative_smoothing);
  CurveWalk<P> walk{curve, curve.start()};
  double last_trial = newton_from / newton_after;
  for (Index step = 0; step < most_factorisations && !run.spent(); ++step) {
    std::optional<SmoothedCourse> here = curve.course(walk.point);
    const bool lost_here = walk.lost_at(here);
    if (lost_here && !walk.go_back()) return false;
    const bool goes_on = !lost_here && !walk.correct(*here);
    if (goes_on) walk.go_on(run, std::move(*here));
    const bool plausible = run.plausible(walk.impulses);
    if (goes_on && !plausible) return false;
    if (plausible && judge_point(run, walk.impulses, goes_on ? walk.taken : 0)) return true;
    if (!goes_on) continue;
    if (walk.point.t < least_smoothing * curve.start().t) return NewtonSteps<P>(problem, run).finish();
    if (run.now.state.residual > newton_after * last_trial) continue;
    last_trial = run.now.state.residual;
    if (NewtonSteps<P>(problem, run).finish()) return true;
  }
  return false;
}

template <ContactProblem P>
void continuation(P& problem, SolverRun<P::dimension>& run) {
  if (run.judge(run.now.impulses)) return;
  for (const double relative_smoothing : {3.0, 0.3, 0.03}) {
    if (follow_curve(problem, run, relative_smoothing)) return;
    run.go_back(run.best());
  }
  if (!run.spent()) run.now.status = FrictionStatus::stalled;
}

}  // namespace nscdd
