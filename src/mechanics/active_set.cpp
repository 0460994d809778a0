// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/active_set.hpp"

#include "core/memory.hpp"
#include "linalg/least_squares.hpp"
#include "linalg/range_projector.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"

#include <fmt/format.h>

namespace nscdd {
namespace {

// Bounds the weights of dependent columns by 1/proximal: their steps would otherwise be rounding. The proximal term is
// centred at the present x, so that it damps steps without changing the solution.
constexpr double proximal = 1e-9;

// Largest step along d that keeps x >= 0.
double step_to_boundary(const Vector& x, const Vector& d) {
  return (d.array() < 0).select(-x.cwiseQuotient(d), infinity).minCoeff();
}

struct SearchDirection {
  Vector x, s;
};

// Newton's direction, which reduces the products x_i s_i by `excess` and `infeasibility` = B^T u - s to 0:
//     s dx + x ds = -excess,   ds = B^T du + infeasibility + proximal dx,   du = B dx
// dx eliminated:  (I + B D B^T) du = -B (excess + x infeasibility) / damped,   D = x / damped. damped = s + proximal x.
SearchDirection newton(const SparseMatrix& b, const SparseCholesky& factor, const Vector& x, const Vector& damped,
                       const Vector& infeasibility, const Vector& excess) {
  const Vector right = excess + x.cwiseProduct(infeasibility);
  const Vector du = factor.solve(Vector(-(b * right.cwiseQuotient(damped))));
  const Vector change = b.transpose() * du;
  const Vector dx = -(right + x.cwiseProduct(change)).cwiseQuotient(damped);
  return {dx, change + infeasibility + proximal * dx};
}

// Projects a point of R^n on { u : B^T u >= 0 }, B sparse n x c without zero columns:
//     u = point + B x,   x >= 0,   s = B^T u >= 0,   x^T s = 0,
// the complementarity problem of B^T B and B^T point. u and s are unique; x is not if columns are dependent.
// Primal-dual interior point method (Mehrotra), one sparse Cholesky factorisation of I + B D B^T, D diagonal, per
// iteration. It follows the central path, so x tends to a maximally complementary solution: x_i > 0 if any solution
// has it (O. Guler, Y. Ye, Math. Program. 60 (1993) 145-162), whatever the choices of the method. It ends with
// x_i s_i <= (0.001 tolerance max |B^T point|)^2 for every i, or once rounding prevents progress. x and s should be of
// comparable size (unit columns). The result has x as its impulses, and the natural map, max |min(x, s)| /
// max |B^T point|, which is 0 at the solution only, as its residual.
UnilateralImpulses project_on_cone(const SparseMatrix& b, const Vector& point, const UnilateralOptions& options,
                                   const Monitor& monitor) {
  UnilateralImpulses result;
  const Vector load = b.transpose() * point;
  Vector& x = result.impulses = Vector::Zero(b.cols());
  Vector slack = load;
  if (b.cols() == 0 || load.minCoeff() >= 0) return result;
  const double scale = load.cwiseAbs().maxCoeff(), columns = static_cast<double>(b.cols());
  const double smallest = std::pow(1e-3 * options.tolerance * scale, 2);
  const SparseMatrix transposed = b.transpose();
  const SparseMatrix identity = diagonal_matrix(Vector::Ones(b.rows()));
  const auto normal_matrix = [&](const Vector& weights) -> SparseMatrix {  // one pattern for all weights
    const SparseMatrix full = b * weights.asDiagonal() * transposed + identity;
    return full.triangularView<Eigen::Lower>();
  };
  const CholeskyAnalysis analysis(normal_matrix(Vector::Ones(b.cols())));
  x.setConstant(scale);
  Vector s = x;
  double previous = infinity;
  while (true) {
    slack = load + b.transpose() * Vector(b * x);
    result.residual = x.cwiseMin(slack).cwiseAbs().maxCoeff() / scale;
    const double mean = x.dot(s) / columns;
    result.converged = result.residual <= options.tolerance;
    const bool stagnates = mean > 0.5 * previous || !std::isfinite(mean);
    if (result.converged && (stagnates || x.cwiseProduct(s).maxCoeff() <= smallest)) break;
    if (result.iterations >= options.maximum_iterations || !std::isfinite(mean)) break;
    previous = mean;

    const Vector damped = s + proximal * x;
    const SparseCholesky factor(analysis, normal_matrix(x.cwiseQuotient(damped)));
    if (!factor.positive_definite()) break;
    ++result.iterations;
    const Vector infeasibility = slack - s;
    const SearchDirection affine = newton(b, factor, x, damped, infeasibility, x.cwiseProduct(s));
    const double reach = std::min({1.0, step_to_boundary(x, affine.x), step_to_boundary(s, affine.s)});
    const double foreseen = (x + reach * affine.x).dot(s + reach * affine.s) / columns;
    const double centre = mean * std::pow(foreseen / mean, 3);
    const Vector excess = (x.array() * s.array() + affine.x.array() * affine.s.array() - centre).matrix();
    const SearchDirection d = newton(b, factor, x, damped, infeasibility, excess);
    const double step = std::min(1.0, 0.995 * std::min(step_to_boundary(x, d.x), step_to_boundary(s, d.s)));
    x += step * d.x;
    s += step * d.s;
    if (!report(monitor, result.iterations, options.maximum_iterations)) break;
  }
  return result;
}

// H^T V, whose rounding is 0: no contact feels velocities that move all of its bodies alike.
Vector separation_speeds(const ReferenceProblem& problem) {
  constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
  Vector speeds = problem.h.transpose() * problem.arriving_velocity;
  const Vector terms = problem.h.cwiseAbs().transpose() * problem.arriving_velocity.cwiseAbs();
  for (Index c = 0; c < speeds.size(); ++c)
    if (std::abs(speeds[c]) <= rounding * terms[c]) speeds[c] = 0;
  return speeds;
}

}  // namespace

RigidImpulses rigid_impulses(const ReferenceProblem& problem) {
  RigidImpulses result;
  const SparseMatrix b = scaled_connectivity(problem.inertia, problem.h);  // M^-1/2 H
  const Vector load = -(problem.inertia.cwiseSqrt().cwiseProduct(problem.arriving_velocity));
  const Vector right = -separation_speeds(problem);
  result.impulses = Vector::Zero(problem.contacts());
  if (problem.contacts() == 0) return result;
  if (problem.contacts() <= dense_impulse_limit) {
    require_memory(bytes_of_matrix(b.rows(), b.cols()), fmt::format("the impulses of {} contacts", b.cols()),
                   "fewer grains");
    const LeastSquares least = minimum_norm_least_squares(Matrix(b), load);
    result.unique = least.rank == problem.contacts();
    result.impulses = least.solution;
  } else {
    result.unique = sparse_rank(problem.h).value == problem.contacts();
    result.impulses = minimum_norm_least_squares(b, load);
  }
  if (right.isZero(0))
    result.impulses.setZero();
  else
    result.residual = (b.transpose() * (b * result.impulses) - right).norm() / right.norm();
  return result;
}

std::vector<char> active_contacts(const ReferenceProblem& problem, const RigidImpulses& rigid) {
  require_arriving_velocity(problem);
  const double largest = rigid.impulses.size() == 0 ? 0.0 : rigid.impulses.cwiseAbs().maxCoeff();
  std::vector<char> active(at(problem.contacts()), 0);
  for (Index c = 0; c < problem.contacts(); ++c) active[at(c)] = rigid.impulses[c] > 1e-10 * largest;
  return active;
}

UnilateralImpulses unilateral_impulses(const ReferenceProblem& problem, const UnilateralOptions& options,
                                       const Monitor& monitor) {
  const Index contacts = problem.contacts();
  if (separation_speeds(problem).isZero(0))
    return {.impulses = Vector::Zero(contacts),
            .velocities = problem.arriving_velocity,
            .separation = Vector::Zero(contacts),
            .status = std::vector(at(contacts), UnilateralStatus::idle)};
  SparseMatrix b = scaled_connectivity(problem.inertia, problem.h);
  Vector root(contacts);  // sqrt(W_ii)
  for (Index c = 0; c < contacts; ++c) root[c] = b.col(c).norm();
  b = b * root.cwiseInverse().asDiagonal();  // M^-1/2 H diag(W)^-1/2, of unit columns
  const Vector point = problem.inertia.cwiseSqrt().cwiseProduct(problem.arriving_velocity);
  const Vector load = b.transpose() * point;
  UnilateralImpulses result = project_on_cone(b, point, options, monitor);
  Vector& scaled = result.impulses;  // r_i sqrt(W_ii)
  const double threshold = contacts == 0 ? 0.0 : options.tolerance * load.cwiseAbs().maxCoeff();
  const Vector scaled_separation = load + b.transpose() * Vector(b * scaled);
  result.status.reserve(at(contacts));
  for (Index c = 0; c < contacts; ++c) {
    const double r = scaled[c], w = scaled_separation[c];
    result.status.push_back(std::max(r, w) <= threshold ? UnilateralStatus::idle
                            : r > w                     ? UnilateralStatus::carrying
                                                        : UnilateralStatus::open);
    // The interior point method leaves impulses of the order of tolerance^2 on contacts that open.
    if (result.status.back() == UnilateralStatus::open) scaled[c] = 0;
  }
  result.impulses = scaled.cwiseQuotient(root).eval();
  result.velocities =
      problem.arriving_velocity + problem.inertia.cwiseInverse().cwiseProduct(Vector(problem.h * result.impulses));
  result.separation = problem.h.transpose() * result.velocities;
  return result;
}

}  // namespace nscdd
