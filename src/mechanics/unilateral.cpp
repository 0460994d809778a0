// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/unilateral.hpp"

#include "linalg/cone_projection.hpp"
#include "linalg/nonnegative_quadratic.hpp"

#include <algorithm>

namespace nscdd {
namespace {

// The unknowns of both methods are r_i sqrt(W_ii).
struct Solution {
  Vector scaled_impulses;
  double residual;
  Index iterations;
  bool converged;
};

Solution by_interior_point(const SparseMatrix& b, const Vector& point, const UnilateralOptions& options,
                           const Monitor& monitor) {
  ConeOptions cone{.tolerance = options.tolerance};
  cone.maximum_iterations = options.maximum_iterations.value_or(cone.maximum_iterations);
  const ConeProjection found = project_on_cone(b, point, cone, monitor);
  return {found.multipliers, found.residual, found.iterations, found.converged};
}

Solution by_projected_gradients(const SparseMatrix& b, const Vector& load, const UnilateralOptions& options,
                                const Monitor& monitor) {
  QuadraticOptions quadratic{.tolerance = options.tolerance};
  quadratic.maximum_iterations = options.maximum_iterations.value_or(quadratic.maximum_iterations);
  const LinearMap delassus = [&](const Vector& x) -> Vector { return b.transpose() * Vector(b * x); };
  // Row sums of |B|^T |B| bound the largest eigenvalue of B^T B.
  const SparseMatrix magnitudes = b.cwiseAbs();
  const Vector sums = magnitudes.transpose() * Vector(magnitudes * Vector::Ones(b.cols()));
  const NonnegativeMinimum found =
      minimize_nonnegative(delassus, load, sums.maxCoeff(), Vector::Zero(b.cols()), quadratic, monitor);
  return {found.x, found.residual, found.iterations, found.converged};
}

}  // namespace

Index UnilateralImpulses::count(UnilateralStatus wanted) const {
  return std::count(status.begin(), status.end(), wanted);
}

UnilateralImpulses unilateral_impulses(const ReferenceProblem& problem, const UnilateralOptions& options,
                                       const Monitor& monitor) {
  UnilateralImpulses result;
  const Index contacts = problem.contacts();
  SparseMatrix b = scaled_connectivity(problem.inertia, problem.h);
  Vector root(contacts);  // sqrt(W_ii)
  for (Index c = 0; c < contacts; ++c) root[c] = b.col(c).norm();
  b = b * root.cwiseInverse().asDiagonal();  // M^-1/2 H diag(W)^-1/2, of unit columns
  const Vector point = problem.inertia.cwiseSqrt().cwiseProduct(problem.arriving_velocity);
  const Vector load = b.transpose() * point;
  Solution found{Vector::Zero(contacts), 0, 0, true};
  if (contacts > 0 && load.minCoeff() < 0)
    found = options.method == UnilateralMethod::interior_point ? by_interior_point(b, point, options, monitor)
                                                               : by_projected_gradients(b, load, options, monitor);
  result.residual = found.residual;
  result.iterations = found.iterations;
  result.converged = found.converged;

  const double threshold = contacts == 0 ? 0.0 : options.tolerance * load.cwiseAbs().maxCoeff();
  const Vector scaled_separation = load + b.transpose() * Vector(b * found.scaled_impulses);
  result.status.reserve(at(contacts));
  for (Index c = 0; c < contacts; ++c) {
    const double r = found.scaled_impulses[c], w = scaled_separation[c];
    result.status.push_back(std::max(r, w) <= threshold ? UnilateralStatus::idle
                            : r > w                     ? UnilateralStatus::carrying
                                                        : UnilateralStatus::open);
    // An interior point leaves a remainder of the order of tolerance^2 on contacts that open.
    if (result.status.back() == UnilateralStatus::open) found.scaled_impulses[c] = 0;
  }
  result.impulses = found.scaled_impulses.cwiseQuotient(root);
  result.velocities =
      problem.arriving_velocity + problem.inertia.cwiseInverse().cwiseProduct(Vector(problem.h * result.impulses));
  result.separation = problem.h.transpose() * result.velocities;
  return result;
}

}  // namespace nscdd
