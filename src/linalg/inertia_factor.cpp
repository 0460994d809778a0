// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/linalg/inertia_factor.hpp>

#include <cmath>

namespace nscdd {

InertiaFactor with_whole_solves(Index negative_eigenvalues, InertiaFactor::Solve solve, const InertiaPattern& pattern) {
  const auto spread = [n = pattern.lower.rows()](const Vector& g) {
    Vector x = Vector::Zero(n);
    x.tail(g.size()) = g;
    return x;
  };
  const auto gather = [border = pattern.border](const Vector& x) -> Vector { return x.tail(border); };
  return {.regular = true,
          .negative_eigenvalues = negative_eigenvalues,
          .solve = solve,
          .solve_from_border = [=](const Vector& g) { return solve(spread(g)); },
          .solve_to_border = [=](const Vector& b) { return gather(solve(b)); },
          .solve_on_border = [=](const Vector& g) { return gather(solve(spread(g))); }};
}

double inexactness(const InertiaFactor& factor, const SparseMatrix& lower, Index border) {
  Vector right = Vector::Zero(lower.rows());
  right.tail(border).setOnes();
  const Vector x = factor.solve_from_border(Vector::Ones(border));
  const Vector correction = factor.solve_to_border(symmetric_residual(lower, x, right));
  const double ratio = correction.norm() / x.tail(border).norm();
  return std::isfinite(ratio) ? ratio : infinity;
}

InertiaMethod first_reliable(InertiaMethod first, InertiaMethod second) {
  const auto analyse = [first, second](const InertiaPattern& pattern) {
    const auto inexact = [border = pattern.border](const InertiaFactor& factor, const SparseMatrix& lower) {
      return factor.regular ? inexactness(factor, lower, border) : infinity;
    };
    const InertiaFamily usual = first.analyse(pattern), other = second.analyse(pattern);
    return InertiaFamily{.factorise =
                             [=](const SparseMatrix& lower, const std::array<double, 2>& parameters) {
                               InertiaFactor factor = usual.factorise(lower, parameters);
                               const double error = inexact(factor, lower);
                               if (error < reliable_inexactness) return factor;
                               InertiaFactor again = other.factorise(lower, parameters);
                               return inexact(again, lower) < error ? again : factor;
                             },
                         .release =
                             [=] {
                               usual.release();
                               other.release();
                             }};
  };
  return {first.name + ", then " + second.name, analyse};
}

Vector symmetric_residual(const SparseMatrix& lower, const Vector& x, const Vector& b) {
  Vector residual = b;
  for (Index j = 0; j < lower.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(lower, j); e; ++e) {
      residual[e.row()] -= e.value() * x[j];
      if (e.row() != j) residual[j] -= e.value() * x[e.row()];
    }
  return residual;
}

}  // namespace nscdd
