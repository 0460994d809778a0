// SPDX-License-Identifier: GPL-3.0-or-later
#include "projected_gradients.hpp"

#include <algorithm>

namespace nscdd::testing {
namespace {

double natural_map(const Vector& x, const Vector& gradient) {
  return x.size() == 0 ? 0.0 : x.cwiseMin(gradient).cwiseAbs().maxCoeff();
}

// Largest step along -p that keeps x >= 0; infinite if every step does.
double feasible_step(const Vector& x, const Vector& p) {
  double step = infinity;
  for (Index i = 0; i < x.size(); ++i)
    if (p[i] > 0) step = std::min(step, x[i] / p[i]);
  return step;
}

// The gradient on the free variables, 0 on those at their bound.
Vector free_part(const Vector& x, const Vector& gradient) { return (x.array() > 0).select(gradient, 0); }

}  // namespace

NonnegativeMinimum minimize_nonnegative(const LinearMap& a, const Vector& b, double largest_eigenvalue, Vector start,
                                        const QuadraticOptions& options, const Monitor& monitor) {
  NonnegativeMinimum result;
  Vector& x = result.x = start.cwiseMax(0);
  const double scale = b.size() == 0 ? 0.0 : b.cwiseAbs().maxCoeff();
  const double fixed_step = 1.9 / largest_eigenvalue;
  const auto product = [&](const Vector& y) {
    ++result.iterations;
    return a(y);
  };
  Vector& gradient = result.gradient = product(x) + b;
  Vector p = free_part(x, gradient);
  while (natural_map(x, gradient) > options.tolerance * scale && result.iterations < options.maximum_iterations) {
    const Vector free = free_part(x, gradient);
    const Vector chopped = (x.array() > 0).select(0.0, gradient.cwiseMin(0));
    if (chopped.squaredNorm() <= (x / fixed_step).cwiseMin(free).dot(free)) {
      const Vector ap = product(p);
      const double curvature = p.dot(ap);
      const double step = gradient.dot(p) / curvature, limit = feasible_step(x, p);
      if (step <= limit) {  // conjugate gradients
        x = (x - step * p).cwiseMax(0);
        gradient -= step * ap;
        const Vector next = free_part(x, gradient);
        p = next - (next.dot(ap) / curvature) * p;
      } else {  // expansion: to the bound, then along the projected gradient
        x = (x - limit * p).cwiseMax(0);
        gradient -= limit * ap;
        x = (x - fixed_step * free_part(x, gradient)).cwiseMax(0);
        gradient = product(x) + b;
        p = free_part(x, gradient);
      }
    } else {  // proportioning: lets bounds go
      const Vector ad = product(chopped);
      const double step = gradient.dot(chopped) / chopped.dot(ad);
      x -= step * chopped;
      gradient -= step * ad;
      p = free_part(x, gradient);
    }
    if (!report(monitor, result.iterations, options.maximum_iterations)) break;
  }
  gradient = product(x) + b;
  result.residual = scale > 0 ? natural_map(x, gradient) / scale : 0.0;
  result.converged = result.residual <= options.tolerance;
  return result;
}

UnilateralImpulses by_projected_gradients(const ReferenceProblem& problem, const QuadraticOptions& options,
                                          const Monitor& monitor) {
  UnilateralImpulses result;
  SparseMatrix b = scaled_connectivity(problem.inertia, problem.h);
  Vector root(problem.contacts());  // sqrt(W_ii)
  for (Index c = 0; c < root.size(); ++c) root[c] = b.col(c).norm();
  b = b * root.cwiseInverse().asDiagonal();
  const Vector load = b.transpose() * problem.inertia.cwiseSqrt().cwiseProduct(problem.arriving_velocity);
  const LinearMap delassus = [&](const Vector& x) -> Vector { return b.transpose() * Vector(b * x); };
  // Row sums of |B|^T |B| bound the largest eigenvalue of B^T B.
  const SparseMatrix magnitudes = b.cwiseAbs();
  const Vector sums = magnitudes.transpose() * Vector(magnitudes * Vector::Ones(b.cols()));
  const NonnegativeMinimum found =
      minimize_nonnegative(delassus, load, sums.maxCoeff(), Vector::Zero(b.cols()), options, monitor);
  result.residual = found.residual;
  result.iterations = found.iterations;
  result.converged = found.converged;
  const double threshold = options.tolerance * load.cwiseAbs().maxCoeff();
  for (Index c = 0; c < root.size(); ++c) {
    const double r = found.x[c], w = found.gradient[c];
    result.status.push_back(std::max(r, w) <= threshold ? UnilateralStatus::idle
                            : r > w                     ? UnilateralStatus::carrying
                                                        : UnilateralStatus::open);
  }
  result.impulses = found.x.cwiseQuotient(root);
  result.velocities =
      problem.arriving_velocity + problem.inertia.cwiseInverse().cwiseProduct(Vector(problem.h * result.impulses));
  result.separation = problem.h.transpose() * result.velocities;
  return result;
}

}  // namespace nscdd::testing
