// SPDX-License-Identifier: GPL-3.0-or-later
// Continuation (Allgower and Georg 1990, chapters 2 and 6) of a smoothed contact law. With z = r - rho u, rho = 1 /
// W_nn of each contact, Coulomb's law is r = P(z). The positive part in P becomes (z + sqrt(z^2 + 4 t)) / 2 and the
// clamp to
// +- b becomes (sqrt((z + b)^2 + 4 t) - sqrt((z - b)^2 + 4 t)) / 2, as in Chen, Harker, Kanzow and Smale, so that
//     F(z, t) = rho (W P_t(z) + q) - P_t(z) + z = t F_0 / t_0,   F_0 = F(z_0, t_0),
// is a smooth curve from (z_0, t_0), any point, to a solution at t = 0. Friction makes t turn on the way: where the
// determinant of dF/dz is negative the curve goes on towards larger t.
#pragma once

#include "contact_solvers/newton.hpp"
#include "contact_solvers/smoothed_law.hpp"

namespace nscdd {

/// A point of the curve.
struct CurvePoint {
  Vector z;
  double t;  // (N s)^2
};

/// What is known of the curve near a point: log t is the parameter.
struct CurveCourse {
  CurvePoint point;
  Vector tangent;                // dz / dlog t
  Vector correction;             // Newton's step to the curve, at right angles to it ...
  double direction;              // of log t along the curve, -1 or 1
  double log_correction = 0;     // ... and that of log t
  double steepest = 0, off = 0;  // largest components of tangent and correction, in units of sqrt(z^2 + 4 t)
  double length = 0;             // of the step from here
};

template <ContactProblem P>
class SmoothedCurve {
 public:
  static constexpr int D = P::dimension;

  SmoothedCurve(P& problem, SolverRun<D>& run, double relative_smoothing)
      : problem_(problem), run_(run), rho_(run.data.normal.cwiseInverse()) {
    constexpr double least_start = 0.1;  // of first impulses, over rho q
    const ContactSums& sums = data_.sums;
    Vector r = run.now.impulses;
    q_ = rho_.cwiseProduct(data_.q + problem.rest(r));
    const double size = sums.norm(q_), entries = static_cast<double>(sums.total(q_.size()));
    // Sweeps know better than any rule how small impulses are.
    if (sums.norm(r) <= (run.now.sweeps > 0 ? 0.0 : least_start) * size)
      for (Index c = 0; c < data_.contacts(); ++c) r[D * c] = std::max(r[D * c], size / std::sqrt(entries));
    start_ = {r - velocities(r) - q_, relative_smoothing * sums.squared_norm(r) / entries};
    slope_ = Vector::Zero(r.size());
    slope_ = defect(start_, impulses(start_)) / start_.t;
  }

  const CurvePoint& start() const { return start_; }

  /// None if the matrix is singular to rounding. With r = P_t(z), dr = P' dz + dP/dt dt leaves
  /// (1 - P') dr + P' rho W dr = ...  of the derivatives of F.
  std::optional<CurveCourse> course(const CurvePoint& point) {
    const Vector defects = defect(point, impulses(point));
    std::vector<ContactRelation<D>> relations(at(data_.contacts()));
    Vector along(point.z.size()), across(point.z.size());
    for (Index c = 0; c < data_.contacts(); ++c) {
      const SmoothedLaw<D> law = smoothed_law(component<D>(point.z, c), data_.friction[c], point.t);
      relations[at(c)] = {law.rest, rho_[D * c] * law.by_z};
      along.segment<D>(D * c) = point.t * (law.by_t + law.by_z * slope_.template segment<D>(D * c));
      across.segment<D>(D * c) = -law.by_z * defects.segment<D>(D * c);
    }
    ++run_.now.factorisations;
    if (!problem_.factorise(std::move(relations))) {
      run_.now.operations += problem_.take_operations();
      return std::nullopt;
    }
    along = problem_.solve(along);
    across = problem_.solve(across);
    CurveCourse found{.point = point,
                      .tangent = along - velocities(along) + point.t * slope_,
                      .correction = across - velocities(across) - defects,
                      .direction = problem_.determinant_sign() < 0 ? 1.0 : -1.0};
    run_.now.operations += problem_.take_operations();
    // Lengths along the curve: the mean of the squared relative changes of z, and the square of that of log t.
    const Vector unit = weight(point), relative = found.tangent.cwiseProduct(unit);
    const ContactSums& sums = data_.sums;
    const double count = static_cast<double>(sums.total(unit.size()));
    const double along_tangent =
        sums.dot(found.correction.cwiseProduct(unit), relative) / (sums.squared_norm(relative) + count);
    found.correction -= along_tangent * found.tangent;
    found.log_correction = -along_tangent;
    found.steepest = sums.largest(relative.cwiseAbs());
    found.off = std::max(sums.largest(found.correction.cwiseProduct(unit).cwiseAbs()), std::abs(found.log_correction));
    return found;
  }

  /// Where a step of this length leads, the correction taken with it.
  static CurvePoint ahead(const CurveCourse& course, double length) {
    const double change = course.direction * length;
    return {course.point.z + course.correction + change * course.tangent,
            course.point.t * std::exp(change + course.log_correction)};
  }

  Vector impulses(const CurvePoint& point) const {
    Vector r(point.z.size());
    for (Index c = 0; c < data_.contacts(); ++c)
      set_component(r, c, smoothed_law(component<D>(point.z, c), data_.friction[c], point.t).impulse);
    return r;
  }

  /// The largest component of F - t F_0 / t_0 with P_t(z) = r, in units of sqrt(z^2 + 4 t).
  double residual(const CurvePoint& point, const Vector& r) const {
    return data_.sums.largest(defect(point, r).cwiseProduct(weight(point)).cwiseAbs());
  }

 private:
  Vector weight(const CurvePoint& point) const { return (point.z.array().square() + 4 * point.t).rsqrt(); }
  // F - t F_0 / t_0, N s.
  Vector defect(const CurvePoint& point, const Vector& r) const {
    return velocities(r) + q_ - r + point.z - point.t * slope_;
  }
  Vector velocities(const Vector& r) const { return rho_.cwiseProduct(problem_.symmetric_product(r)); }  // rho W r

  P& problem_;
  SolverRun<D>& run_;
  const ContactData& data_ = run_.data;
  Vector rho_, q_, slope_;  // slope_: F_0 / t_0
  CurvePoint start_;
};

/// Judges impulses of a point. Returns whether the run is over.
template <int D>
bool judge_point(SolverRun<D>& run, const Vector& impulses, double length) {
  if (!run.judge(impulses, {.length = length})) return false;
  if (run.now.status != FrictionStatus::converged) return true;
  const FrictionSolution smooth = run.now;  // no contact is open or slides while t > 0
  if (!run.judge(run.projected()) || run.now.status != FrictionStatus::converged) run.now = smooth;
  return true;
}

/// Steps along a curve: where they lead, and back from where the curve is lost.
template <ContactProblem P>
struct CurveWalk {
  static constexpr double first_length = 0.5;  // of steps, in log t
  static constexpr double growth = 4, shrinking = 0.7, retreat = 0.3, least_length = 1e-5;
  static constexpr Index most_trials = 10;         // of a step
  static constexpr double largest_change = 5;      // of a component of z in a step, in units of sqrt(z^2 + 4 t)
  static constexpr double largest_residual = 0.2;  // after a step, likewise
  static constexpr double lost = 100;       // Newton's step back to the curve, likewise: from here it is not found ...
  static constexpr double near_curve = 30;  // ... here it is taken together with the next step ...
  static constexpr double on_curve = 0.1;   // ... and here the point is one to come back to
  static constexpr double contraction = 0.6;  // wanted of Newton's steps onto the curve
  static constexpr Index calm_steps = 4;      // after a retreat, for which steps begin on the curve

  const SmoothedCurve<P>& curve;
  CurvePoint point;
  Vector impulses = {};                  // there
  std::optional<CurveCourse> safe = {};  // the last one on the curve
  Index corrections = 0, calm = calm_steps;
  double taken = 0, length = first_length;  // of the last step; what bounds the next one
  double last_off = infinity;

  bool lost_at(const std::optional<CurveCourse>& here) const {
    return !here || !(here->off <= (corrections > 0 ? std::min(lost, contraction * last_off) : lost));
  }
  bool go_back() {
    if (!safe || safe->length < least_length) return false;
    length = safe->length *= retreat;
    move(*safe, length);
    corrections = calm = 0;
    return true;
  }
  bool correct(const CurveCourse& here) {
    last_off = here.off;
    if (here.off <= (calm < calm_steps ? on_curve : near_curve)) return false;
    ++corrections;
    move(here, 0);
    return true;
  }
  void go_on(const SolverRun<P::dimension>& run, CurveCourse here) {
    corrections = 0;
    ++calm;
    const double longest = std::min(largest_change / here.steepest, growth * length);
    bool fits = false;
    for (Index trial = 0; trial < most_trials && !fits; ++trial) {
      taken = trial == 0 ? longest : shrinking * taken;
      move(here, taken);
      fits = curve.residual(point, impulses) <= largest_residual && run.plausible(impulses);
    }
    // Mostly it is the correction that is as far off, and no step would have fitted.
    length = fits ? taken : retreat * longest;
    here.length = taken;
    if (!safe || here.off <= on_curve) safe = std::move(here);
  }
  void move(const CurveCourse& from, double by) {
    point = SmoothedCurve<P>::ahead(from, by);
    impulses = curve.impulses(point);
  }
};

/// Follows the curve of a smoothed contact law from the present impulses (if they are next to none: equal ones), where
/// the smoothing is so many times their mean square. Returns whether the run is over.
template <ContactProblem P>
bool follow_curve(P& problem, SolverRun<P::dimension>& run, double relative_smoothing) {
  constexpr Index most_factorisations = 220;
  constexpr double least_smoothing = 1e-32;  // of t, over its first value: rounding
  constexpr double newton_from = 1e-4;       // residual from which Newton's method is tried ...
  constexpr double newton_after = 0.1;       // ... and again at this part of the residual of the last trial
  if (run.data.sums.all_zero(run.data.q)) return run.judge(Vector::Zero(run.now.impulses.size()));
  SmoothedCurve<P> curve(problem, run, relative_smoothing);
  CurveWalk<P> walk{curve, curve.start()};
  double last_trial = newton_from / newton_after;
  for (Index step = 0; step < most_factorisations && !run.spent(); ++step) {
    std::optional<CurveCourse> here = curve.course(walk.point);
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
