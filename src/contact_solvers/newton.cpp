// SPDX-License-Identifier: GPL-3.0-or-later
// Proximal semismooth Newton (Alart and Curnier 1991). A proximal step replaces u = W r + q by
//     u = W r + q + alpha W_nn (r - r_k),
// whose solution is r_{k+1}: alpha keeps the systems of hyperstatic packings regular. It is solved by Newton's method
// on Phi(r) = (r_n - max(0, z_n), r_t - P_t(z_t)), P_t on the disk of radius mu max(0, z_n), z = r - rho u,
// rho = 1 / (W_nn (1 + alpha)): each of its steps solves the linear system of the statuses that z has, in space with
// the directions of sliding and how they turn.
#include "contact_solvers/contact_solver.hpp"

namespace nscdd {
namespace {

// Of `finish_by_newton`. alpha is in multiples of W_nn everywhere here.
constexpr double first_proximal = 1e-5, least_proximal = 1e-9, most_proximal = 1e-2;
constexpr Index most_steps = 15;

// Of `newton`: alpha falls after a proximal step of few Newton steps and rises after one that took too many.
constexpr Index first_sweeps = 300, few_steps = 6, too_many_steps = 12;
constexpr double cold_proximal = 0.1, coldest_proximal = 1e-10, hottest_proximal = 1e8, change_of_proximal = 4;
constexpr double shortest_step = 0.1;

template <int D>
using FrozenContacts = std::vector<FrozenContact<D>>;

// Directions turn all the time.
template <int D>
bool same_statuses(const FrozenContacts<D>& a, const FrozenContacts<D>& b, const ContactSums& sums) {
  return !sums.any(!std::ranges::equal(a, b, {}, &FrozenContact<D>::status, &FrozenContact<D>::status));
}

// A proximal step from r_k. Its terms vanish where r = r_k.
struct ProximalStep {
  double alpha;
  Vector from;  // r_k

  double rho(double normal) const { return 1 / (normal * (1 + alpha)); }
};

// z of a contact: impulses r with velocities W r + q = u.
template <int D>
LocalVector<D> prediction(const ContactProblem<D>& problem, const ProximalStep& step, const Vector& r, const Vector& u,
                          Index c) {
  const double normal = problem.normal[D * c];
  const LocalVector<D> own = component<D>(r, c), change = own - component<D>(step.from, c);
  return own - step.rho(normal) * (component<D>(u, c) + (step.alpha * normal) * change);
}

template <int D>
FrozenContacts<D> frozen_at(const SolverRun<D>& run, const ProximalStep& step) {
  FrozenContacts<D> statuses;
  for (Index c = 0; c < run.problem.contacts(); ++c)
    statuses.push_back(frozen_contact(prediction(run.problem, step, run.now.impulses, run.now.state.velocities, c),
                                      run.problem.friction[c]));
  return statuses;
}

// || Phi ||, N s.
template <int D>
double merit(const ContactProblem<D>& problem, const ProximalStep& step, const Vector& r, const Vector& u) {
  return std::sqrt(problem.sums.add_up(1, problem.contacts(), [&](Index c, auto&& squares) {
    const LocalVector<D> z = prediction(problem, step, r, u, c);
    const double n = std::max(0.0, z.n), edge = problem.friction[c] * n;
    squares[0] += squared(component<D>(r, c) - LocalVector<D>{n, projected_on_disk(z.t, edge)});
  })[0]);
}

// The impulses r of these statuses; none if their matrix is singular or they are beyond all measure.
template <int D>
std::optional<Vector> impulses_of(SolverRun<D>& run, const Couplings<D>& w, const FrozenContacts<D>& frozen,
                                  const ProximalStep& step) {
  const Vector proximal = step.alpha * run.problem.normal;
  const Vector right = proximal.cwiseProduct(step.from) - run.problem.q - w.rest(run.now.impulses);
  std::vector<ContactRelation<D>> relations;
  Vector b(right.size());
  for (Index c = 0; c < run.problem.contacts(); ++c) {
    relations.push_back(relation_of(frozen[at(c)], proximal[D * c], step.rho(run.problem.normal[D * c])));
    b.segment<D>(D * c) = relations.back().q * right.segment<D>(D * c);
  }
  ++run.now.factorisations;
  std::optional<Vector> found;
  if (w.factorise(std::move(relations))) found = w.solve(b);
  run.now.operations += w.take_operations();
  if (found && !run.plausible(*found)) found.reset();
  return found;
}

enum class Ended { solved, given_up, run_over };

// Newton's method for a proximal step from the present impulses, with steps that shrink until || Phi || falls.
template <int D>
Ended solve_proximal_step(SolverRun<D>& run, const Couplings<D>& w, double alpha, Index& steps) {
  const ProximalStep step{alpha, run.now.impulses};
  const double wanted = std::max(0.01 * run.now.state.residual, 0.1 * run.options.tolerance);
  for (steps = 0; !run.spent(); ++steps) {
    const Vector here = run.now.impulses, velocities = run.now.state.velocities;
    const double size = merit(run.problem, step, here, velocities);
    // Always one step: what Phi takes for solved need not be so to the natural map.
    if (steps > 0 && size <= wanted * std::max(run.problem.sums.norm(here), run.alone)) return Ended::solved;
    if (steps == too_many_steps) return Ended::given_up;
    const std::optional<Vector> found = impulses_of(run, w, frozen_at(run, step), step);
    if (!found) return Ended::given_up;
    const Vector change = *found - here, faster = run.problem.product(change);
    double length = 1;
    while (length > shortest_step &&
           !(merit(run.problem, step, here + length * change, velocities + length * faster) < size))
      length /= 2;
    if (run.judge(here + length * change, {.proximal_weight = alpha, .length = length})) return Ended::run_over;
  }
  return Ended::given_up;
}

}  // namespace

template <int D>
ContactRelation<D> relation_of(const FrozenContact<D>& frozen, double proximal, double rho) {
  ContactRelation<D> relation;
  if (frozen.status == ContactStatus::open) return relation;
  relation.p(0, 0) = proximal;
  relation.q(0, 0) = 1;
  if (frozen.status == ContactStatus::stick) {
    for (Index k = 1; k < D; ++k) {
      relation.p(k, k) = proximal;
      relation.q(k, k) = 1;
    }
  } else if constexpr (D == 2) {
    relation.p(1, 0) = -frozen.slope;
  } else {
    const Eigen::Vector2d slope(frozen.slope.first, frozen.slope.second);
    Eigen::Matrix2d across = Eigen::Matrix2d::Zero();  // turning (I - d d^T)
    if (frozen.turning > 0) {
      const Eigen::Vector2d side = Eigen::Vector2d(-slope.y(), slope.x()).normalized();
      across = frozen.turning * side * side.transpose();
    }
    relation.p.template bottomLeftCorner<2, 1>() = -slope;
    relation.q.template bottomRightCorner<2, 2>() = rho * across;
    relation.p.template bottomRightCorner<2, 2>() += (proximal * rho - 1) * across;
  }
  return relation;
}

template <int D>
bool finish_by_newton(SolverRun<D>& run, const Couplings<D>& w) {
  const double first = run.now.state.residual;
  double alpha = first_proximal, last = first;
  FrozenContacts<D> before;
  for (Index step = 0; step < most_steps && !run.spent() && alpha <= most_proximal; ++step) {
    const FrictionSolution here = run.now;
    const ProximalStep from_here{alpha, here.impulses};
    FrozenContacts<D> frozen = frozen_at(run, from_here);
    const std::optional<Vector> found = impulses_of(run, w, frozen, from_here);
    if (found && run.judge(*found, {.proximal_weight = alpha, .length = 1})) return true;
    if (!found || run.now.state.residual > 30 * first) {  // too far: back, and shorter steps
      run.go_back(here);
      alpha *= 100;
      continue;
    }
    if (same_statuses(frozen, before, run.problem.sums) || run.now.state.residual < 0.1 * last)
      alpha = std::max(alpha / 10, least_proximal);
    last = run.now.state.residual;
    before = std::move(frozen);
  }
  return false;
}

template <int D>
void newton(SolverRun<D>& run) {
  if (sweep(run, std::min(first_sweeps, run.options.maximum_sweeps))) return;
  const Couplings<D> w = run.problem.couplings();
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

template ContactRelation<2> relation_of(const FrozenContact<2>&, double, double);
template ContactRelation<3> relation_of(const FrozenContact<3>&, double, double);
template bool finish_by_newton(SolverRun<2>&, const Couplings<2>&);
template bool finish_by_newton(SolverRun<3>&, const Couplings<3>&);
template void newton(SolverRun<2>&);
template void newton(SolverRun<3>&);

}  // namespace nscdd
