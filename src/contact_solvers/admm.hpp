// SPDX-License-Identifier: GPL-3.0-or-later
// Alternating directions (ADMM): a linear system of all couplings, then the law contact by contact. With De Saxce's
// shift s = mu |u_t| of the velocities that the law sees, u + s n = -rho D l, and D = W_nn of each contact,
//     x <- (W + rho D)^-1 (rho D (z - l) - q - s n),   z <- P(x' + l),   l <- l + x' - z,   x' = 1.6 x - 0.6 z.
// W + rho D is factorised once for each rho. Where M and H are known, M + H (rho D)^-1 H^T is, whole or in subdomains.
#pragma once

#include "contact_solvers/solver_run.hpp"
#include "linalg/threads.hpp"

namespace nscdd {

template <ContactProblem P>
struct AlternatingDirections {
  static constexpr int D = P::dimension;
  static constexpr double first_weight = 0.1, most_weight = 1e8;  // rho

  AlternatingDirections(P& of_problem, SolverRun<D>& of_run)
      : problem(of_problem),
        run(of_run),
        impulses(run.now.impulses),
        multiplier(Vector::Zero(impulses.size())),
        shift(Vector::Zero(data.contacts())) {
    renew_rest();
    if (data.sums.all_zero(impulses)) return;  // the velocities of no impulses are far from those of a solution
    multiplier = -run.now.state.velocities.cwiseQuotient(weight * data.normal);
    for (Index c = 0; c < data.contacts(); ++c) {
      shift[c] = data.friction[c] * norm(component<D>(run.now.state.velocities, c).t);
      multiplier[D * c] -= shift[c] / (weight * data.normal[D * c]);
    }
  }

  void iterate() {
    constexpr double relaxation = 1.6;
    constexpr double renewed_part = 0.1;  // of the shift: renewing all of it cycles if rho is small
    const Vector scaled = weight * data.normal, velocities = -scaled.cwiseProduct(multiplier);
    Vector right = scaled.cwiseProduct(impulses - multiplier) - data.q - rest;
    for (Index c = 0; c < data.contacts(); ++c) {
      shift[c] += renewed_part * (data.friction[c] * norm(component<D>(velocities, c).t) - shift[c]);
      right[D * c] -= shift[c];
    }
    const Vector coupled = problem.solve(right);
    const Vector relaxed = relaxation * coupled + (1 - relaxation) * impulses, before = impulses;
    for (Index c = 0; c < data.contacts(); ++c) {
      const LocalVector<D> moved = component<D>(relaxed, c) + component<D>(multiplier, c);
      set_component(impulses, c, project_on_cone(moved, data.friction[c]));
    }
    multiplier += relaxed - impulses;
    primal = coupled - impulses;
    dual = impulses - before;
    run.now.operations += problem.take_operations();
  }

  /// rho that would balance the primal and the dual residual of the last iteration.
  double balanced_weight() const {
    constexpr double unbalanced = 10;  // the primal residual |x - z| over the dual one, the change of z, or the reverse
    const auto squared = [&](const Vector& x) { return data.sums.dot(x.cwiseAbs2(), data.normal); };
    const double ratio = std::sqrt(squared(primal) / squared(dual));
    if (!(ratio > unbalanced || ratio < 1 / unbalanced)) return weight;
    return weight * std::clamp(std::sqrt(ratio), 0.1, 10.0);
  }

  /// Factorises with another rho, or a larger one if W + rho D is not positive definite. False if none is.
  bool change_weight(double next) {
    for (; next <= most_weight && !run.spent(); next *= 10) {
      multiplier *= weight / next;
      weight = next;
      ++run.now.factorisations;
      const bool regular = problem.factorise_shifted(weight * data.normal);
      run.now.operations += problem.take_operations();
      if (regular) return true;
    }
    return false;
  }

  /// Evaluates the antisymmetric part of W at the present impulses.
  void renew_rest() { rest = problem.rest(impulses); }

  P& problem;
  SolverRun<D>& run;
  const ContactData& data = run.data;
  double weight = first_weight;
  Vector impulses, multiplier, shift, rest;  // z, l, s, the antisymmetric part of W times z
  Vector primal, dual;                       // x - z, and the change of z, in the last iteration
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
    if (run.judge(directions.impulses, {.proximal_weight = directions.weight}) || watch.ends(run)) return;
    directions.renew_rest();
    smallest = std::min(smallest, run.now.state.residual);
    if (run.now.sweeps < next || run.spent()) continue;
    // If the residual does not fall, the shift cycles: with a larger rho it changes more slowly.
    const bool falls = std::exchange(smallest_before, smallest) * fall_wanted >= smallest;
    const double weight = falls ? directions.balanced_weight() : 3 * directions.weight;
    if (weight != directions.weight) regular = directions.change_weight(weight);
    wait *= 2;
    next = run.now.sweeps + wait;
  }
  if (!regular && !run.spent()) run.now.status = FrictionStatus::stalled;
}

}  // namespace nscdd
