// SPDX-License-Identifier: GPL-3.0-or-later
// Accelerated projected gradients with restarts (Mazhar, Heyn, Negrut and Tasora 2015), as in Chrono. For a given shift
// s of De Saxce, contact with friction is the minimum of r^T W r / 2 + r^T (q + s n) over Coulomb's cones. Chrono takes
// s = 0, which lifts sliding contacts. Here an outer loop renews s = mu |u_t|, so that the answer is Coulomb's.
#include "mechanics/contact_solvers/stall_watch.hpp"

namespace nscdd {
namespace {

// The shift is renewed once the residual for the present one is this part of that with the shift renewed.
constexpr double inner_part = 0.3;

// Norms and gradients are those of impulses times the root of W_nn of their contact: masses may be very unequal.
class ProjectedGradients {
 public:
  ProjectedGradients(const SolverRun& run, const Couplings& w)
      : run_(run), w_(w), shift_(Vector::Zero(w.normal.size())) {
    restart(run.now.impulses, velocities(run.now.impulses));
  }

  void renew_shift() {
    for (Index c = 0; c < run_.problem.contacts(); ++c)
      shift_[2 * c] = run_.problem.friction[c] * std::abs(velocity_[2 * c + 1]);
    restart(impulses_, velocity_);
  }

  /// One step. Returns its length in multiples of 1 / W_nn.
  double advance();
  const Vector& impulses() const { return impulses_; }
  Index products() { return std::exchange(products_, 0); }  ///< with W, since the last call
  /// || r - P(r - (W r + q + s n) / W_nn) ||, N s, with the shift as it is.
  double natural_maps() const { return (impulses_ - projected(impulses_, velocity_ + shift_, 1)).norm(); }

 private:
  void restart(const Vector& impulses, const Vector& velocity) {
    impulses_ = ahead_ = impulses;
    velocity_ = velocity_ahead_ = velocity;
    momentum_ = 1;
  }
  Vector velocities(const Vector& impulses) const { return run_.problem.w * impulses + run_.problem.q; }
  Vector projected(const Vector& from, const Vector& gradient, double length) const;

  const SolverRun& run_;
  const Couplings& w_;
  Vector shift_;
  Vector impulses_, ahead_;           // the last ones, and where Nesterov's momentum leads
  Vector velocity_, velocity_ahead_;  // W r + q of both
  double momentum_ = 1, length_ = 1;
  Index products_ = 1;
};

Vector ProjectedGradients::projected(const Vector& from, const Vector& gradient, double length) const {
  Vector result(from.size());
  for (Index c = 0; c < run_.problem.contacts(); ++c) {
    const double t = length / w_.normal[2 * c];
    const LocalVector moved{from[2 * c] - t * gradient[2 * c], from[2 * c + 1] - t * gradient[2 * c + 1]};
    const LocalVector r = project_on_cone(moved, run_.problem.friction[c]);
    result.segment<2>(2 * c) << r.n, r.t;
  }
  return result;
}

double ProjectedGradients::advance() {
  length_ /= 0.9;  // it may grow again
  const Vector gradient = velocity_ahead_ + shift_;
  Vector next, velocity;
  for (;; length_ /= 2) {
    next = projected(ahead_, gradient, length_);
    velocity = velocities(next);
    ++products_;
    const Vector change = next - ahead_;
    const double curved = change.dot(velocity - velocity_ahead_);  // change^T W change
    if (!(curved * length_ > change.cwiseAbs2().dot(w_.normal))) break;
  }
  const double taken = length_;
  if (gradient.dot(next - impulses_) > 0) {
    restart(next, velocity);
    return taken;
  }
  const double before = std::exchange(momentum_, (1 + std::sqrt(1 + 4 * momentum_ * momentum_)) / 2);
  const double beta = (before - 1) / momentum_;
  ahead_ = next + beta * (next - impulses_);
  velocity_ahead_ = velocity + beta * (velocity - velocity_);
  impulses_ = next;
  velocity_ = velocity;
  return taken;
}

}  // namespace

void apgd(SolverRun& run) {
  const FrictionSolverOptions& options = run.options;
  const Couplings w(run.problem);
  ProjectedGradients gradients(run, w);
  StallWatch watch(run);
  double length = not_a_number;
  for (;;) {
    if (run.judge(gradients.impulses(), {.length = length}) || watch.ends(run)) return;
    if (run.now.sweeps >= options.maximum_sweeps) return;
    if (gradients.natural_maps() <= inner_part * run.natural_maps()) gradients.renew_shift();
    const Index many = std::min(options.check_every, options.maximum_sweeps - run.now.sweeps);
    for (Index k = 0; k < many; ++k) length = gradients.advance();
    run.now.sweeps += many;
    run.now.operations += run.product_operations() * static_cast<double>(gradients.products());
  }
}

}  // namespace nscdd
