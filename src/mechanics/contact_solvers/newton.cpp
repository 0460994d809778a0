// SPDX-License-Identifier: GPL-3.0-or-later
// Proximal Newton steps on the statuses of contacts (Alart and Curnier), from impulses near a solution.
#include "mechanics/contact_solvers/contact_solver.hpp"

namespace nscdd {
namespace {

// The proximal term alpha, in multiples of W_nn. It keeps the systems of hyperstatic packings regular, and statuses
// from cycling.
constexpr double first_proximal = 1e-5, least_proximal = 1e-9, most_proximal = 1e-2;
constexpr Index most_steps = 15;

using Statuses = std::vector<ContactStatus>;

// Statuses by z = r - rho (W r + q), with rho = 1 / (W_nn (1 + alpha)) and a friction cone as wide as z_n.
Statuses statuses_at(const SolverRun& run, const Couplings& w, double alpha) {
  Statuses statuses;
  for (Index c = 0; c < run.problem.contacts(); ++c) {
    const double rho = 1 / (w.normal[2 * c] * (1 + alpha));
    statuses.push_back(contact_status(component(run.now.impulses, c) - rho * component(run.now.state.velocities, c),
                                      run.problem.friction[c]));
  }
  return statuses;
}

// Open: r = 0. Stick: u = 0. Slide: u_n = 0 and r_t = +- mu r_n. There u = W r + q + alpha W_nn (r - r_now).
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

// The impulses r of these statuses; none if their matrix is singular.
std::optional<Vector> impulses_of(SolverRun& run, Couplings& w, const Statuses& statuses, double alpha) {
  const Vector proximal = alpha * w.normal;
  const Vector right = proximal.cwiseProduct(run.now.impulses) - run.problem.q - w.rest * run.now.impulses;
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
  return found;
}

}  // namespace

bool finish_by_newton(SolverRun& run, Couplings& w) {
  const double first = run.now.state.residual;
  double alpha = first_proximal, last = first;
  Statuses before;
  for (Index step = 0; step < most_steps && !run.spent() && alpha <= most_proximal; ++step) {
    const Statuses statuses = statuses_at(run, w, alpha);
    const FrictionSolution here = run.now;
    std::optional<Vector> found = impulses_of(run, w, statuses, alpha);
    if (found && !run.plausible(*found)) found.reset();
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

}  // namespace nscdd
