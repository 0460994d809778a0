// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/active_set.hpp"

#include "linalg/least_squares.hpp"
#include "linalg/range_projector.hpp"

namespace nscdd {
RigidImpulses rigid_impulses(const ReferenceProblem& problem) {
  RigidImpulses result;
  const SparseMatrix b = scaled_connectivity(problem.inertia, problem.h);  // M^-1/2 H
  const Vector load = -(problem.inertia.cwiseSqrt().cwiseProduct(problem.arriving_velocity));
  const Vector right = -(problem.h.transpose() * problem.arriving_velocity);
  result.impulses = Vector::Zero(problem.contacts());
  if (problem.contacts() == 0) return result;
  if (problem.contacts() <= dense_impulse_limit) {
    const LeastSquares least = minimum_norm_least_squares(Matrix(b), load);
    result.unique = least.rank == problem.contacts();
    result.impulses = least.solution;
  } else {
    result.unique = sparse_rank(problem.h) == problem.contacts();
    result.impulses = minimum_norm_least_squares(b, load);  // the residual tells how far it got
  }
  if (right.norm() > 0) result.residual = (b.transpose() * (b * result.impulses) - right).norm() / right.norm();
  return result;
}

std::vector<char> active_contacts(const ReferenceProblem& problem, const RigidImpulses& rigid) {
  require_arriving_velocity(problem);
  const double largest = rigid.impulses.size() == 0 ? 0.0 : rigid.impulses.cwiseAbs().maxCoeff();
  std::vector<char> active(at(problem.contacts()), 0);
  for (Index c = 0; c < problem.contacts(); ++c) active[at(c)] = rigid.impulses[c] > 1e-10 * largest;
  return active;
}

}  // namespace nscdd
