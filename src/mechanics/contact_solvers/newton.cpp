// SPDX-License-Identifier: GPL-3.0-or-later
// Proximal semismooth Newton (Alart and Curnier 1991). A proximal step replaces u = W r + q by
//     u = W r + q + alpha W_nn (r - r_k),
// whose solution is r_{k+1}: alpha keeps the systems of hyperstatic packings regular. It is solved by Newton's method
// on Phi(r) = (r_n - max(0, z_n), r_t - clamp(z_t, mu max(0, z_n))), z = r - rho u, rho = 1 / (W_nn (1 + alpha)): each
// of its steps solves the linear system of the statuses that z has.
#include "mechanics/contact_solvers/contact_solver.hpp"

namespace nscdd {
namespace {

// Of `finish_by_newton`. alpha is in multiples of W_nn everywhere here.
constexpr double first_proximal = 1e-5, least_proximal = 1e-9, most_proximal = 1e-2;
constexpr Index most_steps = 15;

// Of `newton`: alpha falls after a proximal step of few Newton steps and rises after one that took too many.
constexpr Index first_sweeps = 300, few_steps = 6, too_many_steps = 12;
constexpr double cold_proximal = 0.1, coldest_proximal = 1e-10, hottest_proximal = 1e8, change_of_proximal = 4;
constexpr double shortest_step = 0.1;

using Statuses = std::vector<ContactStatus>;

// A proximal step from r_k. Its terms vanish where r = r_k.
struct ProximalStep {
  double alpha;
  Vector from;  // r_k
};

// z of a contact: impulses r with velocities W r + q = u.
LocalVector<2> prediction(const Couplings& w, const ProximalStep& step, const Vector& r, const Vector& u, Index c) {
  const double normal = w.normal[2 * c], rho = 1 / (normal * (1 + step.alpha));
  const LocalVector<2> own = component(r, c), change = own - component(step.from, c);
  return own - rho * (component(u, c) + (step.alpha * normal) * change);
}

Statuses statuses_at(const SolverRun& run, const Couplings& w, const ProximalStep& step) {
  Statuses statuses;
  for (Index c = 0; c < run.problem.contacts(); ++c)
    statuses.push_back(
        contact_status(prediction(w, step, run.now.impulses, run.now.state.velocities, c), run.problem.friction[c]));
  return statuses;
}

// || Phi ||, N s.
double merit(const LocalFrictionProblem& problem, const Couplings& w, const ProximalStep& step, const Vector& r,
             const Vector& u) {
  double squares = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const LocalVector<2> z = prediction(w, step, r, u, c);
    const double n = std::max(0.0, z.n), edge = problem.friction[c] * n;
    squares += squared(component(r, c) - LocalVector<2>{n, std::clamp(z.t, -edge, edge)});
  }
  return std::sqrt(squares);
}

// The impulses r of these statuses; none if their matrix is singular or they are beyond all measure.
std::optional<Vector> impulses_of(SolverRun& run, Couplings& w, const Statuses& statuses, const ProximalStep& step) {
  const Vector proximal = step.alpha * w.normal;
  const Vector right = proximal.cwiseProduct(step.from) - run.problem.q - w.rest * run.now.impulses;
  std::vector<ContactRelation> relations;
  Vector b(right.size());
  for (Index c = 0; c < run.problem.contacts(); ++c) {
    relations.push_back(relation_of(statuses[at(c)], run.problem.friction[c], proximal[2 * c]));
    b.segment<2>(2 * c) = relations.back().q * right.segment<2>(2 * c);
  }
  ++run.now.factorisations;
  std::optional<Vector> found;
  if (w.matrix.factorise(std::move(relations))) found = w.matrix.solve(b);
  run.now.operations += w.matrix.take_operations();
  if (found && !run.plausible(*found)) found.reset();
  return found;
}

enum class Ended { solved, given_up, run_over };

// Newton's method for a proximal step from the present impulses, with steps that shrink until || Phi || falls.
Ended solve_proximal_step(SolverRun& run, Couplings& w, double alpha, Index& steps) {
  const ProximalStep step{alpha, run.now.impulses};
  const double wanted = std::max(0.01 * run.now.state.residual, 0.1 * run.options.tolerance);
  for (steps = 0; !run.spent(); ++steps) {
    const Vector here = run.now.impulses, velocities = run.now.state.velocities;
    const double size = merit(run.problem, w, step, here, velocities);
    // Always one step: what Phi takes for solved need not be so to the natural map.
    if (steps > 0 && size <= wanted * std::max(here.norm(), run.judged.alone)) return Ended::solved;
    if (steps == too_many_steps) return Ended::given_up;
    const std::optional<Vector> found = impulses_of(run, w, statuses_at(run, w, step), step);
    if (!found) return Ended::given_up;
    const Vector change = *found - here, faster = run.judged.w * change;
    double length = 1;
    while (length > shortest_step &&
           !(merit(run.problem, w, step, here + length * change, velocities + length * faster) < size))
      length /= 2;
    if (run.judge(here + length * change, {.proximal_weight = alpha, .length = length})) return Ended::run_over;
  }
  return Ended::given_up;
}

}  // namespace

ContactRelation relation_of(ContactStatus status, double friction, double proximal) {
  ContactRelation relation;
  if (status == ContactStatus::open) return relation;
  relation.p(0, 0) = proximal;
  relation.q(0, 0) = 1;
  if (status == ContactStatus::stick) {
    relation.p(1, 1) = proximal;
    relation.q(1, 1) = 1;
  } else {
    relation.p(1, 0) = status == ContactStatus::slide_backward ? -friction : friction;
  }
  return relation;
}

bool finish_by_newton(SolverRun& run, Couplings& w) {
  const double first = run.now.state.residual;
  double alpha = first_proximal, last = first;
  Statuses before;
  for (Index step = 0; step < most_steps && !run.spent() && alpha <= most_proximal; ++step) {
    const FrictionSolution here = run.now;
    const ProximalStep from_here{alpha, here.impulses};
    const Statuses statuses = statuses_at(run, w, from_here);
    const std::optional<Vector> found = impulses_of(run, w, statuses, from_here);
    if (found && run.judge(*found, {.proximal_weight = alpha, .length = 1})) return true;
    if (!found || run.now.state.residual > 30 * first) {  // too far: back, and shorter steps
      run.go_back(here);
      alpha *= 100;
      continue;
    }
    if (statuses == before || run.now.state.residual < 0.1 * last) alpha = std::max(alpha / 10, least_proximal);
    last = run.now.state.residual;
    before = statuses;
  }
  return false;
}

void newton(SolverRun& run) {
  if (sweep(run, std::min(first_sweeps, run.options.maximum_sweeps))) return;
  Couplings w(run.problem, run.linear);
  double alpha = cold_proximal;
  while (!run.spent() && alpha <= hottest_proximal) {
    const FrictionSolution before = run.now;
    Index steps = 0;
    const Ended ended = solve_proximal_step(run, w, alpha, steps);
    if (ended == Ended::run_over) return;
    if (ended == Ended::given_up) {
      run.go_back(before);
      alpha *= change_of_proximal;
    } else if (steps <= few_steps) {
      alpha = std::max(alpha / change_of_proximal, coldest_proximal);
    }
  }
  if (!run.spent()) run.now.status = FrictionStatus::stalled;
}

}  // namespace nscdd
