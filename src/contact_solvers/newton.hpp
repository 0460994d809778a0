// SPDX-License-Identifier: GPL-3.0-or-later
// Proximal semismooth Newton (Alart and Curnier 1991). A proximal step replaces u = W r + q by
//     u = W r + q + alpha W_nn (r - r_k),
// whose solution is r_{k+1}: alpha keeps the systems of hyperstatic packings regular. It is solved by Newton's method
// on Phi(r) = (r_n - max(0, z_n), r_t - P_t(z_t)), P_t on the disk of radius mu max(0, z_n), z = r - rho u,
// rho = 1 / (W_nn (1 + alpha)). Newton's systems are of the statuses of z, in space with derivatives of directions.
#pragma once

#include "contact_solvers/nlgs.hpp"

namespace nscdd {

/// A proximal step from r_k.
struct ProximalStep {
  double alpha;  ///< in multiples of W_nn
  Vector from;   ///< r_k

  double rho(double normal) const { return 1 / (normal * (1 + alpha)); }
};

/// Newton's steps of a run, with alpha in multiples of W_nn.
template <ContactProblem P>
class NewtonSteps {
 public:
  static constexpr int D = P::dimension;
  static constexpr Index few_steps = 6, too_many_steps = 12;  // of a proximal step, after which alpha falls or rises
  enum class Ended { solved, given_up, run_over };

  NewtonSteps(P& problem, SolverRun<D>& run) : problem_(problem), run_(run) {}

  /// Newton's method for a proximal step from the present impulses, with a line search on || Phi ||. Counts `steps`.
  Ended solve_proximal_step(double alpha, Index& steps) {
    constexpr double shortest_step = 0.1;
    const ProximalStep step{alpha, run_.now.impulses};
    const double wanted = std::max(0.01 * run_.now.state.residual, 0.1 * run_.options.tolerance);
    for (steps = 0; !run_.spent(); ++steps) {
      const Vector here = run_.now.impulses, velocities = run_.now.state.velocities;
      const double size = merit(step, here, velocities);
      // At least one step: a small Phi does not imply a small natural map.
      if (steps > 0 && size <= wanted * std::max(data_.sums.norm(here), data_.alone)) return Ended::solved;
      if (steps == too_many_steps) return Ended::given_up;
      const std::optional<Vector> found = impulses_of(frozen_at(step), step);
      if (!found) return Ended::given_up;
      const Vector change = *found - here, faster = problem_.product(change);
      double length = 1;
      while (length > shortest_step && !(merit(step, here + length * change, velocities + length * faster) < size))
        length /= 2;
      if (run_.judge(here + length * change, {.proximal_weight = alpha, .length = length})) return Ended::run_over;
    }
    return Ended::given_up;
  }

  /// A few steps on the statuses from the present impulses. Returns whether the run is over.
  bool finish() {
    constexpr double first_proximal = 1e-5, least_proximal = 1e-9, most_proximal = 1e-2;
    constexpr Index most_steps = 15;
    const double first = run_.now.state.residual;
    double alpha = first_proximal, last = first;
    FrozenContacts before;
    for (Index step = 0; step < most_steps && !run_.spent() && alpha <= most_proximal; ++step) {
      const FrictionSolution here = run_.now;
      const ProximalStep from_here{alpha, here.impulses};
      FrozenContacts frozen = frozen_at(from_here);
      const std::optional<Vector> found = impulses_of(frozen, from_here);
      if (found && run_.judge(*found, {.proximal_weight = alpha, .length = 1})) return true;
      if (!found || run_.now.state.residual > 30 * first) {  // go back, and take shorter steps
        run_.go_back(here);
        alpha *= 100;
        continue;
      }
      // Only statuses are compared: directions of sliding turn in every step.
      const auto status = &FrozenContact<D>::status;
      const bool same_statuses = !data_.sums.any(!std::ranges::equal(frozen, before, {}, status, status));
      if (same_statuses || run_.now.state.residual < 0.1 * last) alpha = std::max(alpha / 10, least_proximal);
      last = run_.now.state.residual;
      before = std::move(frozen);
    }
    return false;
  }

 private:
  using FrozenContacts = std::vector<FrozenContact<D>>;

  // z of a contact: impulses r with velocities W r + q = u.
  LocalVector<D> prediction(const ProximalStep& step, const Vector& r, const Vector& u, Index c) const {
    const double normal = data_.normal[D * c];
    const LocalVector<D> own = component<D>(r, c), change = own - component<D>(step.from, c);
    return own - step.rho(normal) * (component<D>(u, c) + (step.alpha * normal) * change);
  }
  FrozenContacts frozen_at(const ProximalStep& step) const {
    FrozenContacts statuses;
    for (Index c = 0; c < data_.contacts(); ++c)
      statuses.push_back(
          frozen_contact(prediction(step, run_.now.impulses, run_.now.state.velocities, c), data_.friction[c]));
    return statuses;
  }
  // || Phi ||, N s.
  double merit(const ProximalStep& step, const Vector& r, const Vector& u) const {
    return std::sqrt(data_.sums.add_up(1, data_.contacts(), [&](Index c, auto&& squares) {
      const LocalVector<D> z = prediction(step, r, u, c);
      const double n = std::max(0.0, z.n), edge = data_.friction[c] * n;
      squares[0] += squared(component<D>(r, c) - LocalVector<D>{n, projected_on_disk(z.t, edge)});
    })[0]);
  }
  // The impulses of frozen contacts; none if their matrix is singular or they are not plausible.
  std::optional<Vector> impulses_of(const FrozenContacts& frozen, const ProximalStep& step) {
    const Vector proximal = step.alpha * data_.normal;
    const Vector right = proximal.cwiseProduct(step.from) - data_.q - problem_.rest(run_.now.impulses);
    std::vector<ContactRelation<D>> relations;
    Vector b(right.size());
    for (Index c = 0; c < data_.contacts(); ++c) {
      relations.push_back(ContactRelation<D>::of(frozen[at(c)], proximal[D * c], step.rho(data_.normal[D * c])));
      b.segment<D>(D * c) = relations.back().q * right.segment<D>(D * c);
    }
    ++run_.now.factorisations;
    std::optional<Vector> found;
    if (problem_.factorise(std::move(relations))) found = problem_.solve(b);
    run_.now.operations += problem_.take_operations();
    if (found && !run_.plausible(*found)) found.reset();
    return found;
  }

  P& problem_;
  SolverRun<D>& run_;
  const ContactData& data_ = run_.data;
};

template <ContactProblem P>
void newton(P& problem, SolverRun<P::dimension>& run) {
  constexpr Index first_sweeps = 300;
  constexpr double cold_proximal = 0.1, coldest_proximal = 1e-10, hottest_proximal = 1e8, change_of_proximal = 4;
  if (sweep(problem, run, std::min(first_sweeps, run.options.maximum_sweeps))) return;
  using Steps = NewtonSteps<P>;
  Steps method(problem, run);
  double alpha = cold_proximal;
  while (!run.spent() && alpha <= hottest_proximal) {
    const FrictionSolution before = run.now;
    Index steps = 0;
    const auto ended = method.solve_proximal_step(alpha, steps);
    if (ended == Steps::Ended::run_over) return;
    if (ended == Steps::Ended::given_up) {
      run.go_back(before);
      alpha *= change_of_proximal;
    } else if (steps <= Steps::few_steps) {
      alpha = std::max(alpha / change_of_proximal, coldest_proximal);
    }
  }
  if (!run.spent()) run.now.status = FrictionStatus::stalled;
}

}  // namespace nscdd
