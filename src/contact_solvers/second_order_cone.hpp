// SPDX-License-Identifier: GPL-3.0-or-later
// The second-order cone {x_0 >= |(x_1, ..., x_{D-1})|}, its own dual cone; in the plane a quadrant. Its inner points
// have the two eigenvalues x_0 -+ |(x_1, ...)| > 0.
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

template <int D>
using ConeVector = Eigen::Matrix<double, D, 1>;
template <int D>
using ConeBlock = Eigen::Matrix<double, D, D>;

/// J x = (x_0, -x_1, ...).
template <int D>
ConeVector<D> reflected(ConeVector<D> x) {
  x.template tail<D - 1>() *= -1;
  return x;
}
/// The smaller eigenvalue: u_n - mu |u_t| of scaled velocities.
template <int D>
double cone_margin(const ConeVector<D>& x) {
  return x[0] - x.template tail<D - 1>().norm();
}
/// x_0^2 - x_1^2 - ..., the product of both eigenvalues.
template <int D>
double cone_determinant(const ConeVector<D>& x) {
  return cone_margin<D>(x) * (x[0] + x.template tail<D - 1>().norm());
}

/// Jordan's product a o b, with the unit (1, 0, ...).
template <int D>
ConeVector<D> cone_product(const ConeVector<D>& a, const ConeVector<D>& b) {
  ConeVector<D> c = a[0] * b + b[0] * a;
  c[0] = a.dot(b);
  return c;
}
/// The b with a o b = c.
template <int D>
ConeVector<D> cone_quotient(const ConeVector<D>& c, const ConeVector<D>& a) {
  const double first = c.dot(reflected<D>(a)) / cone_determinant<D>(a);
  ConeVector<D> b = (c - first * a) / a[0];
  b[0] = first;
  return b;
}

/// The largest step t with x + t d in the cone, for x inside.
template <int D>
double step_to_edge(const ConeVector<D>& x, const ConeVector<D>& d) {
  const double root = std::sqrt(cone_determinant<D>(x));
  const ConeVector<D> n = x / root;
  const double first = d.dot(reflected<D>(n));
  const ConeVector<D> turned = d - (first + d[0]) / (n[0] + 1) * n;
  const double fall = turned.template tail<D - 1>().norm() - first;
  return fall > 0 ? root / fall : infinity;
}

/// The scaling of Nesterov and Todd of x and z inside the cone: symmetric F with F z = F^-1 x.
template <int D>
struct ConeScaling {
  ConeBlock<D> factor, inverse;  ///< F and F^-1

  ConeScaling(const ConeVector<D>& x, const ConeVector<D>& z) {
    const double det_x = cone_determinant<D>(x), det_z = cone_determinant<D>(z),
                 size = std::sqrt(std::sqrt(det_x / det_z));
    const ConeVector<D> a = x / std::sqrt(det_x), b = z / std::sqrt(det_z), e = ConeVector<D>::Unit(0);
    const ConeVector<D> w = (a + reflected<D>(b)) / std::sqrt(2 * (1 + a.dot(b)));  // of determinant 1
    const ConeVector<D> up = w + e, down = reflected<D>(w) + e;
    ConeBlock<D> minus_j = ConeBlock<D>::Identity();
    minus_j(0, 0) = -1;
    factor = size * (minus_j + up * up.transpose() / (1 + w[0]));
    inverse = (minus_j + down * down.transpose() / (1 + w[0])) / size;
  }
};

}  // namespace nscdd
