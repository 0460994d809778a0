// SPDX-License-Identifier: GPL-3.0-or-later
// Proximal Newton steps on the statuses of contacts (Alart and Curnier), from impulses near a solution.
#include "linalg/sparse_lu.hpp"
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

// How many unknowns each status has: none open, two sticking (r_n, r_t), one sliding (r_n, r_t = +- mu r_n).
struct Unknowns {
  SparseMatrix impulses;    // 2c x k: r of the unknowns
  SparseMatrix velocities;  // 2c x k: the components of u that vanish
};
Unknowns unknowns_of(const LocalFrictionProblem& problem, const Statuses& statuses) {
  std::vector<Eigen::Triplet<double, int>> impulses, velocities;
  int next = 0;
  for (std::size_t c = 0; c < statuses.size(); ++c) {
    if (statuses[c] == ContactStatus::open) continue;
    const int normal = static_cast<int>(2 * c), tangent = normal + 1;
    impulses.emplace_back(normal, next, 1.0);
    velocities.emplace_back(normal, next, 1.0);
    if (statuses[c] == ContactStatus::stick) {
      ++next;
      impulses.emplace_back(tangent, next, 1.0);
      velocities.emplace_back(tangent, next, 1.0);
    } else {
      const double mu = problem.friction[static_cast<Index>(c)];
      impulses.emplace_back(tangent, next, statuses[c] == ContactStatus::slide_backward ? mu : -mu);
    }
    ++next;
  }
  Unknowns result{SparseMatrix(2 * problem.contacts(), next), SparseMatrix(2 * problem.contacts(), next)};
  result.impulses.setFromTriplets(impulses.begin(), impulses.end());
  result.velocities.setFromTriplets(velocities.begin(), velocities.end());
  return result;
}

// The impulses r of these statuses with u = W r + q + alpha W_nn (r - r_now); none if their matrix is singular.
std::optional<Vector> impulses_of(SolverRun& run, const Couplings& w, const Statuses& statuses, double alpha) {
  const Unknowns unknowns = unknowns_of(run.problem, statuses);
  if (unknowns.impulses.cols() == 0) return Vector::Zero(run.now.impulses.size());
  const Vector proximal = alpha * w.normal;
  SparseMatrix left = w.symmetric * unknowns.impulses;
  left += SparseMatrix(proximal.asDiagonal() * unknowns.impulses);
  const SparseMatrix matrix = SparseMatrix(unknowns.velocities.transpose()) * left;
  const Vector right = proximal.cwiseProduct(run.now.impulses) - run.problem.q - w.rest * run.now.impulses;
  SparseLu lu(matrix);
  ++run.now.factorisations;
  std::optional<Vector> found;
  if (lu.factorise(matrix)) found = unknowns.impulses * lu.solve(matrix, unknowns.velocities.transpose() * right);
  run.now.operations += lu.operations();
  return found;
}

}  // namespace

bool finish_by_newton(SolverRun& run, const Couplings& w) {
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
