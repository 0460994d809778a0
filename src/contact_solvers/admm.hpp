// SPDX-License-Identifier: GPL-3.0-or-later
// Alternating directions (ADMM): a linear system of all couplings, then the law contact by contact. With De Saxce's
// shift s = mu |u_t| of the velocities that the law sees, u + s n = -rho D l, and D = W_nn of each contact,
//     x <- (W + rho D)^-1 (rho D (z - l) - q - s n),   z <- P(x' + l),   l <- l + x' - z,   x' = 1.6 x - 0.6 z.
// W + rho D is factorised once for each rho. Where M and H are known M + H (rho D)^-1 H^T takes its place, whole or cut
// into subdomains.
#pragma once

#include "contact_solvers/solver_run.hpp"
#include "linalg/threads.hpp"

namespace nscdd {

template <ContactProblem P>
class AlternatingDirections {
 public:
  static constexpr int D = P::dimension;
  static constexpr double first_weight = 0.1, most_weight = 1e8;  // rho

  AlternatingDirections(P& problem, SolverRun<D>& run)
      : problem_(problem),
        run_(run),
        impulses_(run.now.impulses),
        multiplier_(Vector::Zero(impulses_.size())),
        shift_(Vector::Zero(data_.contacts())) {
    renew_rest();
    if (data_.sums.all_zero(impulses_)) return;  // the velocities of no impulses are far from those of a solution
    multiplier_ = -run.now.state.velocities.cwiseQuotient(weight_ * data_.normal);
    for (Index c = 0; c < data_.contacts(); ++c) {
      shift_[c] = data_.friction[c] * norm(component<D>(run.now.state.velocities, c).t);
      multiplier_[D * c] -= shift_[c] / (weight_ * data_.normal[D * c]);
    }
  }

  void iterate() {
    constexpr double relaxation = 1.6;
    constexpr double renewed_part = 0.1;  // of the shift: renewing all of it cycles if rho is small
    const Vector scaled = weight_ * data_.normal, velocities = -scaled.cwiseProduct(multiplier_);
    Vector right = scaled.cwiseProduct(impulses_ - multiplier_) - data_.q - rest_;
    for (Index c = 0; c < data_.contacts(); ++c) {
      shift_[c] += renewed_part * (data_.friction[c] * norm(component<D>(velocities, c).t) - shift_[c]);
      right[D * c] -= shift_[c];
    }
    const Vector coupled = problem_.solve(right);
    const Vector relaxed = relaxation * coupled + (1 - relaxation) * impulses_, before = impulses_;
    for (Index c = 0; c < data_.contacts(); ++c) {
      const LocalVector<D> moved = component<D>(relaxed, c) + component<D>(multiplier_, c);
      set_component(impulses_, c, project_on_cone(moved, data_.friction[c]));
    }
    multiplier_ += relaxed - impulses_;
    primal_ = coupled - impulses_;
    dual_ = impulses_ - before;
    run_.now.operations += problem_.take_operations();
  }

  /// rho that would balance the primal and the dual residual of the last iteration.
  double balanced_weight() const {
    constexpr double unbalanced = 10;  // the primal residual |x - z| over the dual one, the change of z, or the reverse
    const auto squared = [&](const Vector& x) { return data_.sums.dot(x.cwiseAbs2(), data_.normal); };
    const double ratio = std::sqrt(squared(primal_) / squared(dual_));
    if (!(ratio > unbalanced || ratio < 1 / unbalanced)) return weight_;
    return weight_ * std::clamp(std::sqrt(ratio), 0.1, 10.0);
  }

  /// Factorises with another rho, or a larger one if W + rho D is not positive definite. False if none is.
  bool change_weight(double weight) {
    for (; weight <= most_weight && !run_.spent(); weight *= 10) {
      multiplier_ *= weight_ / weight;
      weight_ = weight;
      ++run_.now.factorisations;
      const bool regular = problem_.factorise_shifted(weight_ * data_.normal);
      run_.now.operations += problem_.take_operations();
      if (regular) return true;
    }
    return false;
  }

  /// Evaluates the antisymmetric part of W at the present impulses.
  void renew_rest() { rest_ = problem_.rest(impulses_); }
  const Vector& impulses() const { return impulses_; }
  double weight() const { return weight_; }

 private:
  P& problem_;
  SolverRun<D>& run_;
  const ContactData& data_ = run_.data;
  double weight_ = first_weight;
  Vector impulses_, multiplier_, shift_, rest_;  // z, l, s, the antisymmetric part of W times z
  Vector primal_, dual_;                         // x - z, and the change of z, in the last iteration
};

template <ContactProblem P>
void admm(P& problem, SolverRun<P::dimension>& run) {
  constexpr Index first_wait = 500;    // iterations with the first rho; twice as many with each further one
  constexpr double fall_wanted = 0.3;  // of the smallest residual with one rho
  const FrictionSolverOptions& options = run.options;
  if (run.judge(run.now.impulses) || run.spent()) return;
  const OneBlasThread serial_blas;  // here, because switching it in each solve is expensive
  AlternatingDirections<P> directions(problem, run);
  bool regular = directions.change_weight(directions.first_weight);
  StallWatch<P::dimension> watch(run);
  double smallest = infinity, smallest_before = infinity;
  for (Index wait = first_wait, next = wait; regular && run.now.sweeps < options.maximum_sweeps;) {
    const Index many = std::min(options.check_every, options.maximum_sweeps - run.now.sweeps);
    for (Index k = 0; k < many; ++k) directions.iterate();
    run.now.sweeps += many;
    if (run.judge(directions.impulses(), {.proximal_weight = directions.weight()}) || watch.ends(run)) return;
    directions.renew_rest();
    smallest = std::min(smallest, run.now.state.residual);
    if (run.now.sweeps < next || run.spent()) continue;
    // If the residual does not fall, the shift cycles: with a larger rho it changes more slowly.
    const bool falls = std::exchange(smallest_before, smallest) * fall_wanted >= smallest;
    const double weight = falls ? directions.balanced_weight() : 3 * directions.weight();
    if (weight != directions.weight()) regular = directions.change_weight(weight);
    wait *= 2;
    next = run.now.sweeps + wait;
  }
  if (!regular && !run.spent()) run.now.status = FrictionStatus::stalled;
}

}  // namespace nscdd
