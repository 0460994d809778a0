// SPDX-License-Identifier: GPL-3.0-or-later
// Interior point method for the linear complementarity problem that plane contact with Coulomb friction is, without
// any approximation of the cone. With r_t = a - b and the sliding speed l, all of these are >= 0 and
//     r_n u_n = 0,   a (l + u_t) = 0,   b (l - u_t) = 0,   l (mu r_n - a - b) = 0.
// The central path replaces each 0 by one gap > 0, which falls (Mehrotra's predictor and corrector, Wright 1997,
// chapter 10). The problem is not monotone: the path may turn, so infeasibility is taken away no faster than the gap.
#include "mechanics/contact_solvers/contact_solver.hpp"

namespace nscdd {
namespace {

constexpr double to_boundary = 0.99;  // part of the way to the boundary that a step may go
constexpr double short_steps = 0.12;  // steps that are shorter on average lead nowhere
constexpr Index most_steps = 80;
constexpr double least_friction = 1e-12;  // what is below it is none
constexpr double newton_from = 1e-3;      // residual from which Newton's method is tried ...
constexpr double newton_after = 0.2;      // ... and again at this part of the residual of the last trial

// One column per pair of complementary quantities: (r_n, u_n), (a, l + u_t), (b, l - u_t), (l, mu r_n - a - b).
using Pairs = Eigen::Array<double, Eigen::Dynamic, 4>;
enum Pair : Index { normal, forward, backward, speed };

struct Direction {
  Pairs x, y;
  Vector u_t;
};

// A point of the interior, in units in which the mean of W_nn and the largest component of q are 1.
class InteriorPoint {
 public:
  InteriorPoint(const LocalFrictionProblem& problem, Couplings& w, const Vector& impulses, double relative_gap);

  /// One step towards a smaller gap. Returns its length, 0 if there is no direction.
  double advance();
  /// Goes to the point next to the present impulses where every product is the gap times `factor`.
  void centre_again(double factor) { centre(own_impulses(), factor * gap()); }
  Vector impulses() const { return impulse_unit_ * own_impulses(); }

 private:
  bool rubs(Index c) const { return friction_[c] > least_friction; }
  Vector own_impulses() const;
  void centre(const Vector& r, double gap);
  double gap() const;
  double gap_after(double length, const Direction& d) const;
  double longest(const Direction& d, double part) const;
  bool factorise();
  Direction towards(const Pairs& products, double kept_residual) const;

  Couplings& w_;
  Vector friction_, q_;
  double impulse_unit_, w_unit_;
  Pairs x_, y_, counted_;  // counted_: 1 for the pairs that a contact has, else 0
  Vector u_t_, residual_;  // residual_: W r + q - u
  Pairs ratio_;            // forward, backward: a / (l + u_t), b / (l - u_t); speed: E; normal: T
};

InteriorPoint::InteriorPoint(const LocalFrictionProblem& problem, Couplings& w, const Vector& impulses,
                             double relative_gap)
    : w_(w), friction_(problem.friction), counted_(Pairs::Zero(friction_.size(), 4)) {
  w_unit_ = w.normal.mean();
  impulse_unit_ = problem.q.cwiseAbs().maxCoeff() / w_unit_;
  q_ = (problem.q + w.rest * impulses) / (w_unit_ * impulse_unit_);
  const Index contacts = problem.contacts();
  for (Index c = 0; c < contacts; ++c) counted_.row(c).head(rubs(c) ? 4 : 1) = 1;
  Vector r = impulses / impulse_unit_;
  if (r.isZero(0))
    for (Index c = 0; c < contacts; ++c) r[2 * c] = 1;
  centre(r, relative_gap * r.squaredNorm() / static_cast<double>(2 * contacts));
}

// The point next to r where every product is `gap`. It obeys all but u = W r + q.
void InteriorPoint::centre(const Vector& r, double gap) {
  const Vector u = w_.symmetric * r / w_unit_ + q_;
  x_ = y_ = Pairs::Ones(friction_.size(), 4);
  u_t_ = Vector::Zero(friction_.size());
  const double root = std::sqrt(gap);
  for (Index c = 0; c < friction_.size(); ++c) {
    const double n = r[2 * c] - u[2 * c], length = std::hypot(n, 2 * root);
    x_(c, normal) = n > 0 ? (n + length) / 2 : 2 * gap / (length - n);
    y_(c, normal) = gap / x_(c, normal);
    if (!rubs(c)) continue;
    // A contact that slides at the speed v is 2 gap / v inside the edge of its cone.
    const double edge = friction_[c] * x_(c, normal);
    const double least = std::min(edge, 2 * gap / std::max(std::abs(u[2 * c + 1]), root));
    const double inside = std::clamp(edge - std::abs(r[2 * c + 1]), least, edge), r_t = edge - inside;
    // a + b is the root of a quadratic: (edge + far) / 3. The rest follows without cancellation.
    const double far = std::hypot(edge, std::sqrt(3.0) * r_t), sum = (edge + far) / 3;
    const bool is_forward = r[2 * c + 1] > 0;
    y_(c, speed) = inside * (2 * edge - inside) / (2 * edge + far);
    x_(c, is_forward ? forward : backward) = (sum + r_t) / 2;
    x_(c, is_forward ? backward : forward) = sum * y_(c, speed) / (sum + r_t);
    for (const Pair pair : {forward, backward}) y_(c, pair) = gap / x_(c, pair);
    x_(c, speed) = gap / y_(c, speed);
    u_t_[c] = (y_(c, forward) - y_(c, backward)) / 2;
  }
}

double InteriorPoint::gap() const { return (x_ * y_ * counted_).sum() / counted_.sum(); }

Vector InteriorPoint::own_impulses() const {
  Vector r(2 * friction_.size());
  for (Index c = 0; c < friction_.size(); ++c) {
    r[2 * c] = x_(c, normal);
    r[2 * c + 1] = rubs(c) ? x_(c, forward) - x_(c, backward) : 0.0;
  }
  return r;
}

double InteriorPoint::gap_after(double length, const Direction& d) const {
  return ((x_ + length * d.x) * (y_ + length * d.y) * counted_).sum() / counted_.sum();
}

// A part of the way along which all stay >= 0, at most 1.
double InteriorPoint::longest(const Direction& d, double part) const {
  const auto limit = [](const Pairs& at, const Pairs& by) { return (by < 0).select(-at / by, infinity).minCoeff(); };
  return std::min({1.0, part * limit(x_, d.x), part * limit(y_, d.y)});
}

// Eliminating all but dr leaves (W + D) dr = ..., where D couples the two components of a contact.
bool InteriorPoint::factorise() {
  ratio_ = Pairs::Ones(x_.rows(), 4);
  std::vector<ContactRelation> relations(at(friction_.size()));
  for (Index c = 0; c < friction_.size(); ++c) {
    Eigen::Matrix2d& p = relations[at(c)].p;
    relations[at(c)].q.setIdentity();
    p(0, 0) = y_(c, normal) / x_(c, normal);
    if (rubs(c)) {
      const double a = x_(c, forward) / y_(c, forward), b = x_(c, backward) / y_(c, backward);
      const double l = x_(c, speed), e = l * (a + b) + y_(c, speed), t = (4 * l * a * b + y_(c, speed) * (a + b)) / e;
      ratio_.row(c) << t, a, b, e;
      p(1, 0) = -(a - b) * l * friction_[c] / (e * t);
      p(1, 1) = 1 / t;
      p *= w_unit_;
    } else {
      p(0, 0) *= w_unit_;
      relations[at(c)].q(1, 1) = 0;  // r_t stays 0
    }
  }
  return w_.matrix.factorise(std::move(relations));
}

// The direction in which the products change by `products` and u nears W r + q by the part `kept_residual`.
Direction InteriorPoint::towards(const Pairs& products, double kept_residual) const {
  const Index contacts = friction_.size();
  Vector right = -kept_residual * residual_, tangential = Vector::Zero(contacts), sliding = Vector::Zero(contacts);
  for (Index c = 0; c < contacts; ++c) {
    right[2 * c] += products(c, normal) / x_(c, normal);
    if (!rubs(c)) right[2 * c + 1] = 0;
    if (!rubs(c)) continue;
    const double t = ratio_(c, normal), a = ratio_(c, forward), b = ratio_(c, backward), e = ratio_(c, speed);
    const double p = products(c, forward) / y_(c, forward), m = products(c, backward) / y_(c, backward);
    sliding[c] = products(c, speed) + x_(c, speed) * (p + m);
    tangential[c] = p - m - (a - b) * sliding[c] / e;
    right[2 * c + 1] += tangential[c] / t;
  }
  const Vector dr = w_.matrix.solve(w_unit_ * right);
  Direction d{Pairs::Zero(contacts, 4), Pairs::Zero(contacts, 4), Vector::Zero(contacts)};
  for (Index c = 0; c < contacts; ++c) {
    const double dn = dr[2 * c], l = x_(c, speed), mu = friction_[c];
    d.x(c, normal) = dn;
    d.y(c, normal) = (products(c, normal) - y_(c, normal) * dn) / x_(c, normal);
    if (!rubs(c)) continue;
    const double t = ratio_(c, normal), a = ratio_(c, forward), b = ratio_(c, backward), e = ratio_(c, speed);
    const double dut = (tangential[c] + (a - b) * l * mu / e * dn - dr[2 * c + 1]) / t;
    const double dl = (sliding[c] - l * mu * dn - l * (a - b) * dut) / e;
    d.u_t[c] = dut;
    d.x(c, speed) = dl;
    d.y(c, forward) = dl + dut;
    d.y(c, backward) = dl - dut;
    d.x(c, forward) = (products(c, forward) - x_(c, forward) * (dl + dut)) / y_(c, forward);
    d.x(c, backward) = (products(c, backward) - x_(c, backward) * (dl - dut)) / y_(c, backward);
    d.y(c, speed) = mu * dn - d.x(c, forward) - d.x(c, backward);
  }
  return d;
}

double InteriorPoint::advance() {
  residual_ = w_.symmetric * own_impulses() / w_unit_ + q_;
  for (Index c = 0; c < friction_.size(); ++c) {
    residual_[2 * c] -= y_(c, normal);
    residual_[2 * c + 1] = rubs(c) ? residual_[2 * c + 1] - u_t_[c] : 0.0;
  }
  if (!factorise()) return 0;
  const double now = gap();
  const Pairs products = -x_ * y_ * counted_;
  const Direction predictor = towards(products, 1);
  const double predicted = longest(predictor, 1);
  double centring = std::pow(gap_after(predicted, predictor) / now, 3);
  centring = std::isfinite(centring) ? std::clamp(centring, predicted < 0.1 ? 0.3 : 1e-6, 0.98) : 0.98;
  const Direction d =
      towards(products + counted_ * (centring * now) - predicted * predicted * predictor.x * predictor.y, 1 - centring);
  if (!d.x.allFinite() || !d.y.allFinite()) return 0;
  const double length = longest(d, to_boundary);
  x_ += length * d.x;
  y_ += length * d.y;
  u_t_ += length * d.u_t;
  return length;
}

}  // namespace

bool follow_path(SolverRun& run, Couplings& w, double relative_gap) {
  if (run.problem.q.isZero(0)) return run.judge(Vector::Zero(run.now.impulses.size()));
  InteriorPoint point(run.problem, w, run.now.impulses, relative_gap);
  double last_trial = newton_from / newton_after;
  double usual_length = 1;
  bool centred = false;
  for (Index step = 0; step < most_steps && !run.spent(); ++step) {
    const double length = point.advance();
    ++run.now.factorisations;
    run.now.operations += w.matrix.take_operations();
    const Vector impulses = point.impulses();
    if (!run.plausible(impulses)) return false;
    if (run.judge(impulses, {.length = length})) {
      if (run.now.status != FrictionStatus::converged) return true;
      const FrictionSolution inner = run.now;  // no contact is open or slides in the interior
      if (!run.judge(run.projected())) run.now = inner;
      return true;
    }
    usual_length = 0.7 * usual_length + 0.3 * length;
    if (usual_length < short_steps) {
      if (std::exchange(centred, true)) return false;
      point.centre_again(10);
      usual_length = 1;
    }
    const double residual = run.now.state.residual;
    if (residual > newton_after * last_trial) continue;
    last_trial = residual;
    if (finish_by_newton(run, w)) return true;
  }
  return false;
}

void interior_point(SolverRun& run) {
  if (run.judge(run.now.impulses)) return;
  Couplings w(run.problem, run.linear);
  for (const double relative_gap : {3.0, 0.3, 0.03}) {
    if (follow_path(run, w, relative_gap)) return;
    run.go_back(run.best());
  }
  if (!run.spent()) run.now.status = FrictionStatus::stalled;
}

}  // namespace nscdd
