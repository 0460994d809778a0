// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/cone_projection.hpp"

#include "linalg/sparse_cholesky.hpp"

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

// Bounds the weights of dependent columns by 1/proximal, whose steps would otherwise drown in rounding. The
// proximal term is centred at the present x: it damps steps and leaves the solution as it is.
constexpr double proximal = 1e-9;

// Largest step along d that keeps x >= 0.
double step_to_boundary(const Vector& x, const Vector& d) {
  double step = infinity;
  for (Index i = 0; i < x.size(); ++i)
    if (d[i] < 0) step = std::min(step, -x[i] / d[i]);
  return step;
}

// I + B D B^T, lower triangle; one pattern for every D.
class NormalMatrix {
 public:
  explicit NormalMatrix(const SparseMatrix& b) : b_(b), transposed_(b.transpose()), identity_(b.rows(), b.rows()) {
    identity_.setIdentity();
  }
  SparseMatrix at(const Vector& weights) const {
    const SparseMatrix full = b_ * weights.asDiagonal() * transposed_ + identity_;
    return full.triangularView<Eigen::Lower>();
  }

 private:
  const SparseMatrix& b_;
  SparseMatrix transposed_, identity_;
};

struct Direction {
  Vector x, s;
};

// Newton's direction, which takes `excess` off the products x_i s_i and `infeasibility` = B^T u - s to
// nothing:
//     s dx + x ds = -excess,   ds = B^T du + infeasibility + proximal dx,   du = B dx
// dx eliminated:  (I + B D B^T) du = -B (excess + x infeasibility) / damped,   D = x / damped.
// damped = s + proximal x.
Direction newton(const SparseMatrix& b, const SparseCholesky& factor, const Vector& x, const Vector& damped,
                 const Vector& infeasibility, const Vector& excess) {
  const Vector right = excess + x.cwiseProduct(infeasibility);
  const Vector du = factor.solve(Vector(-(b * right.cwiseQuotient(damped))));
  const Vector change = b.transpose() * du;
  Direction d;
  d.x = -(right + x.cwiseProduct(change)).cwiseQuotient(damped);
  d.s = change + infeasibility + proximal * d.x;
  return d;
}

}  // namespace

ConeProjection project_on_cone(const SparseMatrix& b, const Vector& point, const ConeOptions& options,
                               const Monitor& monitor) {
  ConeProjection result;
  const Vector load = b.transpose() * point;
  Vector& x = result.multipliers = Vector::Zero(b.cols());
  result.slack = load;
  if (b.cols() == 0 || load.minCoeff() >= 0) return result;
  const double scale = load.cwiseAbs().maxCoeff(), columns = static_cast<double>(b.cols());
  const double smallest = std::pow(1e-3 * options.tolerance * scale, 2);
  const NormalMatrix normal(b);
  const CholeskyAnalysis analysis(normal.at(Vector::Ones(b.cols())));
  x.setConstant(scale);
  Vector s = x;
  double previous = infinity;
  while (true) {
    result.slack = load + b.transpose() * Vector(b * x);
    result.residual = x.cwiseMin(result.slack).cwiseAbs().maxCoeff() / scale;
    const double mean = x.dot(s) / columns;
    result.converged = result.residual <= options.tolerance;
    const bool stagnates = mean > 0.5 * previous || !std::isfinite(mean);
    if (result.converged && (stagnates || x.cwiseProduct(s).maxCoeff() <= smallest)) break;
    if (result.iterations >= options.maximum_iterations || !std::isfinite(mean)) break;
    previous = mean;

    const Vector damped = s + proximal * x;
    const SparseCholesky factor(analysis, normal.at(x.cwiseQuotient(damped)));
    if (!factor.positive_definite()) break;
    ++result.iterations;
    const Vector infeasibility = result.slack - s;
    const Direction affine = newton(b, factor, x, damped, infeasibility, x.cwiseProduct(s));
    const double reach = std::min({1.0, step_to_boundary(x, affine.x), step_to_boundary(s, affine.s)});
    const double foreseen = (x + reach * affine.x).dot(s + reach * affine.s) / columns;
    const double centre = mean * std::pow(foreseen / mean, 3);
    const Vector excess = (x.array() * s.array() + affine.x.array() * affine.s.array() - centre).matrix();
    const Direction d = newton(b, factor, x, damped, infeasibility, excess);
    const double step = std::min(1.0, 0.995 * std::min(step_to_boundary(x, d.x), step_to_boundary(s, d.s)));
    x += step * d.x;
    s += step * d.s;
    if (!report(monitor, result.iterations, options.maximum_iterations)) break;
  }
  return result;
}

}  // namespace nscdd
