// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_entries.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

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

double inexactness(const InertiaFactor& factor, const SparseMatrix& lower, Index border, const Processes& processes) {
  const Vector ones = Vector::Ones(border), x = factor.solve_from_border(ones);
  const Vector correction = factor.solve_to_border(border_residual(lower, x, ones, processes));
  const double ratio = correction.norm() / x.tail(border).norm();
  return std::isfinite(ratio) ? ratio : infinity;
}

InertiaMethod first_reliable(InertiaMethod first, InertiaMethod second) {
  const auto analyse = [first, second](const InertiaPattern& pattern) {
    const auto inexact = [border = pattern.border](const InertiaFactor& factor, const SparseMatrix& lower) {
      return factor.regular ? inexactness(factor, lower, border) : infinity;
    };
    const InertiaFamily usual = first.analyse(pattern), other = second.analyse(pattern);
    const auto factorise = [=](const SparseMatrix& lower, const std::array<double, 2>& parameters) {
      InertiaFactor factor = usual.factorise(lower, parameters);
      const double error = inexact(factor, lower);
      if (error < reliable_inexactness) return factor;
      InertiaFactor again = other.factorise(lower, parameters);
      return inexact(again, lower) < error ? again : factor;
    };
    const auto release = [=] {
      usual.release();
      other.release();
    };
    return InertiaFamily{factorise, release};
  };
  return {first.name + ", then " + second.name, analyse};
}

Vector symmetric_residual(const SparseMatrix& lower, const Vector& x, const Vector& b) {
  Vector residual = b;
  for_entries(lower, [&](Index i, Index j, double value) {
    residual[i] -= value * x[j];
    if (i != j) residual[j] -= value * x[i];
  });
  return residual;
}

Vector border_residual(const SparseMatrix& lower, const Vector& x, const Vector& g, const Processes& processes) {
  const Index border = g.size();
  Vector right = Vector::Zero(x.size());
  if (processes.first()) right.tail(border) = g;
  Vector residual = symmetric_residual(lower, x, right);
  processes.add_up({residual.data() + residual.size() - border, at(border)});
  return residual;
}

}  // namespace nscdd
