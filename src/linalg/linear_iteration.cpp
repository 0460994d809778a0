// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/linear_iteration.hpp"

namespace nscdd {

IteratedSolution conjugate_gradients(const LinearMap& a, const LinearMap& p_inverse, const Vector& b,
                                     const IterationLimits& limits) {
  IteratedSolution result{.x = Vector::Zero(b.size())};
  const double size = b.norm();
  if (size == 0) return result;
  Vector residual = b, z = p_inverse(residual), direction = z;
  double product = residual.dot(z);
  result.residual = 1;
  while (result.residual > limits.tolerance && result.iterations < limits.maximum) {
    const Vector image = a(direction);
    ++result.iterations;
    const double length = product / direction.dot(image);
    if (!std::isfinite(length)) break;
    result.x += length * direction;
    residual -= length * image;
    result.residual = residual.norm() / size;
    if (result.residual <= limits.tolerance) break;
    z = p_inverse(residual);
    const double next = residual.dot(z);
    direction = z + (next / product) * direction;
    product = next;
  }
  result.converged = result.residual <= limits.tolerance;
  return result;
}

IteratedSolution generalised_minimal_residuals(const LinearMap& a, const LinearMap& p_inverse, const Vector& b,
                                               const IterationLimits& limits) {
  IteratedSolution result{.x = Vector::Zero(b.size())};
  const double size = b.norm();
  if (size == 0) return result;
  std::vector<Vector> basis{b / size}, directions;  // orthonormal; P^-1 of it
  std::vector<Vector> columns;                      // of the Hessenberg matrix, turned into a triangle
  std::vector<std::array<double, 2>> turns;         // (cos, sin) of each
  std::vector<double> right{size};
  result.residual = 1;
  while (result.residual > limits.tolerance && result.iterations < limits.maximum) {
    directions.push_back(p_inverse(basis.back()));
    Vector next = a(directions.back());
    ++result.iterations;
    Vector column = Vector::Zero(count(basis) + 1);
    for (int pass = 0; pass < 2; ++pass)  // the second removes the rounding of the first
      for (std::size_t k = 0; k < basis.size(); ++k) {
        const double part = basis[k].dot(next);
        column[static_cast<Index>(k)] += part;
        next -= part * basis[k];
      }
    const double length = next.norm();
    column[count(basis)] = length;
    for (std::size_t k = 0; k < turns.size(); ++k) {
      const auto i = static_cast<Index>(k);
      const double upper = column[i], lower = column[i + 1];
      column[i] = turns[k][0] * upper + turns[k][1] * lower;
      column[i + 1] = turns[k][0] * lower - turns[k][1] * upper;
    }
    const Index last = count(basis) - 1;
    const double diagonal = std::hypot(column[last], column[last + 1]);
    if (!(diagonal > 0) || !std::isfinite(diagonal)) break;
    turns.push_back({column[last] / diagonal, column[last + 1] / diagonal});
    column[last] = diagonal;
    columns.push_back(column);
    const double rest = right.back();
    right.back() = turns.back()[0] * rest;
    right.push_back(-turns.back()[1] * rest);
    result.residual = std::abs(right.back()) / size;
    if (length == 0) break;
    basis.push_back(next / length);
  }
  for (Index k = count(columns) - 1; k >= 0; --k) {  // `right` becomes the coefficients of the directions
    right[at(k)] /= columns[at(k)][k];
    for (Index i = 0; i < k; ++i) right[at(i)] -= columns[at(k)][i] * right[at(k)];
    result.x += right[at(k)] * directions[at(k)];
  }
  result.converged = result.residual <= limits.tolerance;
  // All diagonal entries of the triangle are positive, and the square matrix does not contain the last turn.
  result.determinant_sign = !turns.empty() && turns.back()[0] < 0 ? -1 : 1;
  return result;
}

Index predicted_iterations(const Eigen::VectorXcd& eigenvalues, const IterationLimits& limits) {
  const LinearMap map = [&](const Vector& x) {
    Vector y(x.size());
    for (Index k = 0; k < x.size(); ++k) {
      const double re = eigenvalues[k].real(), im = eigenvalues[k].imag();
      y[k] = re * x[k];
      if (im == 0 || k + 1 == x.size()) continue;
      y[k] -= im * x[k + 1];  // a complex pair rotates a plane
      y[k + 1] = im * x[k] + re * x[k + 1];
      ++k;
    }
    return y;
  };
  const LinearMap same = [](const Vector& x) { return x; };
  return generalised_minimal_residuals(map, same, Vector::Ones(eigenvalues.size()), limits).iterations;
}

}  // namespace nscdd
