// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/linalg/range_projector.hpp>
#include <nscdd/mechanics/active_set.hpp>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/QR>

namespace nscdd {
namespace {

constexpr Index dense_limit = 1000;

}  // namespace

RigidImpulses rigid_impulses(const ReferenceProblem& problem) {
  RigidImpulses result;
  const SparseMatrix b = scaled_connectivity(problem.inertia, problem.h);  // M^-1/2 H
  const Vector load = -(problem.inertia.cwiseSqrt().cwiseProduct(problem.arriving_velocity));
  const Vector right = -(problem.h.transpose() * problem.arriving_velocity);
  result.impulses = Vector::Zero(problem.contacts());
  if (problem.contacts() == 0) return result;
  if (problem.contacts() <= dense_limit) {
    Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
    decomposition.setThreshold(1e-10);
    decomposition.compute(Matrix(b));
    result.unique = decomposition.rank() == problem.contacts();
    result.impulses = decomposition.solve(load);
  } else {
    // From a zero start the iterates stay in the range of B^T, so the limit is the least-norm solution.
    result.unique = sparse_rank(b) == problem.contacts();
    Eigen::LeastSquaresConjugateGradient<SparseMatrix> solver;
    solver.setTolerance(1e-13);
    solver.setMaxIterations(20 * problem.contacts());
    solver.compute(b);
    result.impulses = solver.solve(load);
  }
  if (right.norm() > 0)
    result.residual = (b.transpose() * (b * result.impulses) - right).norm() / right.norm();
  return result;
}

std::vector<char> active_contacts(const ReferenceProblem& problem, const RigidImpulses& rigid) {
  if (problem.arriving_velocity.size() == 0 || problem.arriving_velocity.isZero(0))
    throw Error(
        "active contacts: expected a prescribed velocity (a [[prescribed]] table in the case, or "
        "--prescribed GRAIN:VX:VY), met none");
  const double largest = rigid.impulses.size() == 0 ? 0.0 : rigid.impulses.cwiseAbs().maxCoeff();
  if (largest == 0)
    throw Error(
        "active contacts: expected a prescribed velocity that loads some contact, met one that loads none");
  std::vector<char> active(at(problem.contacts()), 0);
  for (Index c = 0; c < problem.contacts(); ++c) active[at(c)] = rigid.impulses[c] > 1e-10 * largest;
  return active;
}

}  // namespace nscdd
