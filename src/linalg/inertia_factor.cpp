// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_entries.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

namespace nscdd {

double inexactness(const InertiaFactor& factor, const SparseMatrix& lower, Index border, const Processes& processes) {
  const Vector ones = Vector::Ones(border), x = factor.solve_from_border(ones);
  const Vector correction = factor.solve_to_border(border_residual(lower, x, ones, processes));
  const double ratio = correction.norm() / x.tail(border).norm();
  return std::isfinite(ratio) ? ratio : infinity;
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
