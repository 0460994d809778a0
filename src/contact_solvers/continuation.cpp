// SPDX-License-Identifier: GPL-3.0-or-later
// Continuation (Allgower and Georg 1990, chapters 2 and 6) of a smoothed contact law. With z = r - rho u, rho = 1 /
// W_nn of each contact, Coulomb's law is r = P(z). The positive part in P becomes (z + sqrt(z^2 + 4 t)) / 2 and the
// clamp to
// +- b becomes (sqrt((z + b)^2 + 4 t) - sqrt((z - b)^2 + 4 t)) / 2, as in Chen, Harker, Kanzow and Smale, so that
//     F(z, t) = rho (W P_t(z) + q) - P_t(z) + z = t F_0 / t_0,   F_0 = F(z_0, t_0),
// is a smooth curve from (z_0, t_0), any point, to a solution at t = 0. Friction makes t turn on the way: where the
// determinant of dF/dz is negative the curve goes on towards larger t.
#include "contact_solvers/contact_solver.hpp"

namespace nscdd {
namespace {

constexpr Index most_factorisations = 220;
constexpr double least_start = 0.1;        // of first impulses, over rho q
constexpr double least_smoothing = 1e-32;  // of t, over its first value: rounding
constexpr double first_length = 0.5;       // of steps, in log t
constexpr double growth = 4, shrinking = 0.7, retreat = 0.3, least_length = 1e-5;
constexpr Index most_trials = 10;         // of a step
constexpr double largest_change = 5;      // of a component of z in a step, in units of sqrt(z^2 + 4 t)
constexpr double largest_residual = 0.2;  // after a step, likewise
constexpr double lost = 100;              // Newton's step back to the curve, likewise: from here it is not found ...
constexpr double near_curve = 30;         // ... here it is taken together with the next step ...
constexpr double on_curve = 0.1;          // ... and here the point is one to come back to
constexpr double contraction = 0.6;       // wanted of Newton's steps onto the curve
constexpr Index calm_steps = 4;           // after a retreat, for which steps begin on the curve
constexpr double newton_from = 1e-4;      // residual from which Newton's method is tried ...
constexpr double newton_after = 0.1;      // ... and again at this part of the residual of the last trial

// P_t(z) of a contact and its derivatives by z, and by t.
template <int D>
struct SmoothedLaw {
  using Block = Eigen::Matrix<double, D, D>;
  LocalVector<D> impulse;
  Block by_z, rest;  // rest: 1 - P', regular whatever the rounding
  Eigen::Matrix<double, D, 1> by_t;
};

constexpr double least_rest = 1e-14;

SmoothedLaw<2> smoothed_law(LocalVector<2> z, double friction, double t) {
  const auto length = [&](double x) { return std::sqrt(x * x + 4 * t); };
  const double h = length(z.n);
  SmoothedLaw<2> law;
  law.impulse.n = z.n > 0 ? (z.n + h) / 2 : 2 * t / (h - z.n);
  const double edge = friction * law.impulse.n, n = law.impulse.n / h;
  const double forward = length(z.t + edge), backward = length(z.t - edge);
  law.impulse.t = 2 * z.t * edge / (forward + backward);
  const double f = (z.t + edge) / forward, b = (z.t - edge) / backward;
  law.by_z << n, 0, friction * n * (f + b) / 2, (f - b) / 2;
  law.by_t << 1 / h, 1 / forward - 1 / backward + friction * (f + b) / (2 * h);
  law.rest = Eigen::Matrix2d::Identity() - law.by_z;
  law.rest.diagonal() = law.rest.diagonal().cwiseMax(least_rest);
  return law;
}

// The same along d = z_t / |z_t|; across it the derivative is |r_t| / |z_t|.
SmoothedLaw<3> smoothed_law(LocalVector<3> z, double friction, double t) {
  const double size = norm(z.t);
  const SmoothedLaw<2> along = smoothed_law(LocalVector<2>{z.n, size}, friction, t);
  const auto length = [&](double x) { return std::sqrt(x * x + 4 * t); };
  const double edge = friction * along.impulse.n;
  const double across = 2 * edge / (length(size + edge) + length(size - edge));
  const Eigen::Vector2d d = size > 0 ? Eigen::Vector2d(z.t.first / size, z.t.second / size) : Eigen::Vector2d(1, 0);
  const auto turned = [&](double in_direction, double beside) -> Eigen::Matrix2d {
    return beside * Eigen::Matrix2d::Identity() + (in_direction - beside) * d * d.transpose();
  };
  SmoothedLaw<3> law;
  law.impulse = {along.impulse.n, across * z.t};
  law.by_z << along.by_z(0, 0), 0, 0, along.by_z(1, 0) * d, turned(along.by_z(1, 1), across);
  law.by_t << along.by_t[0], along.by_t[1] * d;
  law.rest << along.rest(0, 0), 0, 0, along.rest(1, 0) * d, turned(along.rest(1, 1), std::max(1 - across, least_rest));
  return law;
}

struct Point {
  Vector z;
  double t;  // (N s)^2
};

// What is known of the curve near a point: log t is the parameter.
struct Course {
  Point point;
  Vector tangent;                // dz / dlog t
  Vector correction;             // Newton's step to the curve, at right angles to it ...
  double direction;              // of log t along the curve, -1 or 1
  double log_correction = 0;     // ... and that of log t
  double steepest = 0, off = 0;  // largest components of tangent and correction, in units of sqrt(z^2 + 4 t)
  double length = first_length;
};

template <int D>
class SmoothedCurve {
 public:
  SmoothedCurve(SolverRun<D>& run, const Couplings<D>& w, double relative_smoothing);

  const Point& start() const { return start_; }
  /// None if the matrix is singular to rounding.
  std::optional<Course> course(const Point& point);
  /// Where a step of this length leads, the correction taken with it.
  static Point ahead(const Course& course, double length);
  Vector impulses(const Point& point) const;
  /// The largest component of F - t F_0 / t_0 with P_t(z) = `impulses`, in units of sqrt(z^2 + 4 t).
  double residual(const Point& point, const Vector& impulses) const;

 private:
  Vector weight(const Point& point) const { return (point.z.array().square() + 4 * point.t).rsqrt(); }
  Vector defect(const Point& point, const Vector& impulses) const;
  Vector velocities(const Vector& r) const { return rho_.cwiseProduct(w_.product(r)); }  // rho W r

  SolverRun<D>& run_;
  const Couplings<D>& w_;
  Vector rho_, q_, slope_;  // slope_: F_0 / t_0
  Point start_;
};

template <int D>
SmoothedCurve<D>::SmoothedCurve(SolverRun<D>& run, const Couplings<D>& w, double relative_smoothing)
    : run_(run), w_(w), rho_(run.problem.normal.cwiseInverse()) {
  const ContactSums& sums = run.problem.sums;
  Vector r = run.now.impulses;
  q_ = rho_.cwiseProduct(run.problem.q + w.rest(r));
  const double size = sums.norm(q_), entries = static_cast<double>(sums.total(q_.size()));
  // Sweeps know better than any rule how small impulses are.
  if (sums.norm(r) <= (run.now.sweeps > 0 ? 0.0 : least_start) * size)
    for (Index c = 0; c < run.problem.contacts(); ++c) r[D * c] = std::max(r[D * c], size / std::sqrt(entries));
  start_ = {r - velocities(r) - q_, relative_smoothing * sums.squared_norm(r) / entries};
  slope_ = Vector::Zero(r.size());
  slope_ = defect(start_, impulses(start_)) / start_.t;
}

template <int D>
Vector SmoothedCurve<D>::impulses(const Point& point) const {
  Vector r(point.z.size());
  for (Index c = 0; c < run_.problem.contacts(); ++c)
    set_component(r, c, smoothed_law(component<D>(point.z, c), run_.problem.friction[c], point.t).impulse);
  return r;
}

// F - t F_0 / t_0, N s.
template <int D>
Vector SmoothedCurve<D>::defect(const Point& point, const Vector& r) const {
  return velocities(r) + q_ - r + point.z - point.t * slope_;
}

template <int D>
double SmoothedCurve<D>::residual(const Point& point, const Vector& r) const {
  return run_.problem.sums.largest(defect(point, r).cwiseProduct(weight(point)).cwiseAbs());
}

// With r = P_t(z), dr = P' dz + dP/dt dt leaves  (1 - P') dr + P' rho W dr = ...  of the derivatives of F.
template <int D>
std::optional<Course> SmoothedCurve<D>::course(const Point& point) {
  const Vector defects = defect(point, impulses(point));
  std::vector<ContactRelation<D>> relations(at(run_.problem.contacts()));
  Vector along(point.z.size()), across(point.z.size());
  for (Index c = 0; c < run_.problem.contacts(); ++c) {
    const SmoothedLaw<D> law = smoothed_law(component<D>(point.z, c), run_.problem.friction[c], point.t);
    relations[at(c)] = {law.rest, rho_[D * c] * law.by_z};
    along.segment<D>(D * c) = point.t * (law.by_t + law.by_z * slope_.template segment<D>(D * c));
    across.segment<D>(D * c) = -law.by_z * defects.segment<D>(D * c);
  }
  ++run_.now.factorisations;
  if (!w_.factorise(std::move(relations))) {
    run_.now.operations += w_.take_operations();
    return std::nullopt;
  }
  along = w_.solve(along);
  across = w_.solve(across);
  Course found{.point = point,
               .tangent = along - velocities(along) + point.t * slope_,
               .correction = across - velocities(across) - defects,
               .direction = w_.determinant_sign() < 0 ? 1.0 : -1.0};
  run_.now.operations += w_.take_operations();
  // Lengths along the curve: the mean of the squared relative changes of z, and the square of that of log t.
  const Vector unit = weight(point), relative = found.tangent.cwiseProduct(unit);
  const ContactSums& sums = run_.problem.sums;
  const double count = static_cast<double>(sums.total(unit.size()));
  const double along_tangent =
      sums.dot(found.correction.cwiseProduct(unit), relative) / (sums.squared_norm(relative) + count);
  found.correction -= along_tangent * found.tangent;
  found.log_correction = -along_tangent;
  found.steepest = sums.largest(relative.cwiseAbs());
  found.off = std::max(sums.largest(found.correction.cwiseProduct(unit).cwiseAbs()), std::abs(found.log_correction));
  return found;
}

template <int D>
Point SmoothedCurve<D>::ahead(const Course& course, double length) {
  const double change = course.direction * length;
  return {course.point.z + course.correction + change * course.tangent,
          course.point.t * std::exp(change + course.log_correction)};
}

// Judges impulses of a point. Returns whether the run is over.
template <int D>
bool judge_point(SolverRun<D>& run, const Vector& impulses, double length) {
  if (!run.judge(impulses, {.length = length})) return false;
  if (run.now.status != FrictionStatus::converged) return true;
  const FrictionSolution smooth = run.now;  // no contact is open or slides while t > 0
  if (!run.judge(run.projected()) || run.now.status != FrictionStatus::converged) run.now = smooth;
  return true;
}

// Steps along a curve: where they lead, and back from where the curve is lost.
template <int D>
struct Walk {
  const SmoothedCurve<D>& curve;
  Point point;
  Vector impulses = {};             // there
  std::optional<Course> safe = {};  // the last one on the curve
  Index corrections = 0, calm = calm_steps;
  double taken = 0, length = first_length;  // of the last step; what bounds the next one
  double last_off = infinity;

  bool lost_at(const std::optional<Course>& here) const {
    return !here || !(here->off <= (corrections > 0 ? std::min(lost, contraction * last_off) : lost));
  }
  bool go_back() {
    if (!safe || safe->length < least_length) return false;
    length = safe->length *= retreat;
    move(*safe, length);
    corrections = calm = 0;
    return true;
  }
  bool correct(const Course& here) {
    last_off = here.off;
    if (here.off <= (calm < calm_steps ? on_curve : near_curve)) return false;
    ++corrections;
    move(here, 0);
    return true;
  }
  void go_on(const SolverRun<D>& run, Course here) {
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
  void move(const Course& from, double by) {
    point = SmoothedCurve<D>::ahead(from, by);
    impulses = curve.impulses(point);
  }
};

}  // namespace

template <int D>
bool follow_curve(SolverRun<D>& run, const Couplings<D>& w, double relative_smoothing) {
  if (run.problem.sums.all_zero(run.problem.q)) return run.judge(Vector::Zero(run.now.impulses.size()));
  SmoothedCurve<D> curve(run, w, relative_smoothing);
  Walk<D> walk{curve, curve.start()};
  double last_trial = newton_from / newton_after;
  for (Index step = 0; step < most_factorisations && !run.spent(); ++step) {
    std::optional<Course> here = curve.course(walk.point);
    const bool lost_here = walk.lost_at(here);
    if (lost_here && !walk.go_back()) return false;
    const bool goes_on = !lost_here && !walk.correct(*here);
    if (goes_on) walk.go_on(run, std::move(*here));
    const bool plausible = run.plausible(walk.impulses);
    if (goes_on && !plausible) return false;
    if (plausible && judge_point(run, walk.impulses, goes_on ? walk.taken : 0)) return true;
    if (!goes_on) continue;
    if (walk.point.t < least_smoothing * curve.start().t) return finish_by_newton(run, w);
    if (run.now.state.residual > newton_after * last_trial) continue;
    last_trial = run.now.state.residual;
    if (finish_by_newton(run, w)) return true;
  }
  return false;
}

template <int D>
void continuation(SolverRun<D>& run) {
  if (run.judge(run.now.impulses)) return;
  const Couplings<D> w = run.problem.couplings();
  for (const double relative_smoothing : {3.0, 0.3, 0.03}) {
    if (follow_curve(run, w, relative_smoothing)) return;
    run.go_back(run.best());
  }
  if (!run.spent()) run.now.status = FrictionStatus::stalled;
}

template bool follow_curve(SolverRun<2>&, const Couplings<2>&, double);
template bool follow_curve(SolverRun<3>&, const Couplings<3>&, double);
template void continuation(SolverRun<2>&);
template void continuation(SolverRun<3>&);

}  // namespace nscdd
