// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/largest_margin.hpp"
#include "contact_solvers/solver_run.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"
#include <nscdd/contact_solvers/verdict.hpp>

namespace nscdd {
namespace {

constexpr double plausible_speed = 1e6;  // over max |q_c|: no step moves so fast

// Brings A r to rounding, A = H_N or W_N of the chain, by steps that are small where r is small; the largest r is 1.
//     r <- r - X A^T (A X A^T + tiny)^-1 A r,   X = diag(r)^2.
Vector polished(const LocalFrictionProblem& problem, std::vector<Index> chain, Vector r) {
  constexpr int most_steps = 10;
  constexpr double tiny = 1e-13;
  for (Index& c : chain) c *= problem.dimension;
  const SparseMatrix columns = problem.h.cols() > 0 ? problem.h : SparseMatrix(problem.w.transpose());
  const SparseMatrix a = selected_columns(columns, chain), t = a.transpose();
  const SparseMatrix unit = diagonal_matrix(Vector::Ones(a.rows()));
  r /= r.maxCoeff();
  for (int step = 0; step < most_steps; ++step) {
    const SparseMatrix product = SparseMatrix(a * r.cwiseAbs2().asDiagonal()) * t;
    const SparseMatrix matrix = product + tiny * product.diagonal().maxCoeff() * unit;
    const SparseCholesky factor(CholeskyAnalysis(matrix), matrix);
    if (!factor.positive_definite()) break;
    Vector next = r - r.cwiseAbs2().cwiseProduct(t * Vector(factor.solve(a * r)));
    next /= next.maxCoeff();
    if (!(next.minCoeff() > 0) || !((a * next).lpNorm<1>() < (a * r).lpNorm<1>())) break;
    r = std::move(next);
  }
  return r;
}

// Takes as certificate the contacts whose impulses outweigh their slack, first where this is clear. Fewer replace more.
void take_chain(const LocalFrictionProblem& problem, const LargestMargin& found, Verdict& verdict) {
  const double enough = plausible_speed * speed_scale(problem), largest = found.impulses.maxCoeff();
  for (const double share : {1e4, 1e2, 1.0, 1e-2}) {
    std::vector<Index> chain;
    for (Index c = 0; c < found.impulses.size(); ++c)
      if (found.impulses[c] > share * largest * std::max(found.slack[c], 1e-6)) chain.push_back(c);
    if (chain.empty()) continue;
    const Vector stress = polished(problem, chain, found.impulses(chain));
    const double speed = proven_speed(problem, chain, stress);
    if (verdict.proven_speed >= enough ? speed < enough || count(chain) >= count(verdict.chain)
                                       : speed <= verdict.proven_speed)
      continue;
    verdict.proven_speed = speed;
    verdict.stress = stress;
    verdict.closing_speed = 0;
    for (Index i = 0; i < count(chain); ++i)
      verdict.closing_speed -= stress[i] * problem.q[problem.dimension * chain[at(i)]];
    verdict.chain = std::move(chain);
    if (speed >= enough) return;
  }
}

}  // namespace

bool proves_impossible(const Verdict& verdict, bool converged, double driven_residual) {
  constexpr double tight = 1e-6;
  return verdict.kind == VerdictKind::impossible && !(converged && driven_residual < tight);
}

Verdict verdict_of(const LocalFrictionProblem& problem, const Monitor& monitor) {
  const auto start = Clock::now();
  Verdict verdict;
  verdict.kind = VerdictKind::exists;
  if (problem.contacts() == 0) return verdict;
  const auto margin_of = [&](const LocalFrictionProblem& of, const Vector& friction, const Vector& weights) {
    LargestMargin found = largest_margin(of, friction, weights, monitor);
    verdict.factorisations += found.factorisations;
    return found;
  };
  const Vector equal = Vector::Ones(problem.contacts());
  LargestMargin found = margin_of(problem, problem.friction, equal);
  verdict.margin = proven_margin(problem, problem.friction, found.velocities);
  verdict.speed = found.speed;
  verdict.velocities = std::move(found.velocities);
  if (!(verdict.margin > 0)) {
    verdict.kind = VerdictKind::undecided;
    const Vector frictionless = Vector::Zero(problem.contacts());
    found = margin_of(problem, frictionless, equal);
    for (const Vector& velocities : {found.velocities, verdict.velocities})
      verdict.normal_margin = std::fmax(verdict.normal_margin, proven_margin(problem, frictionless, velocities));
    if (verdict.normal_margin < 0) take_chain(problem, found, verdict);
    if (verdict.proven_speed >= plausible_speed * speed_scale(problem)) verdict.kind = VerdictKind::impossible;
    // Weights that fall with the impulse, and that differ, make the chain shorter and choose among equal ones.
    std::size_t before = verdict.chain.size() + 1;
    while (verdict.kind == VerdictKind::impossible && verdict.chain.size() < before) {
      before = verdict.chain.size();
      Vector weights = Vector::LinSpaced(equal.size(), 1, static_cast<double>(equal.size())).array().sin().exp();
      for (Index i = 0; i < verdict.stress.size(); ++i) weights[verdict.chain[at(i)]] /= 1 + 10 * verdict.stress[i];
      take_chain(problem, margin_of(problem, frictionless, weights), verdict);
    }
  }
  verdict.seconds = seconds_since(start);
  return verdict;
}

}  // namespace nscdd
