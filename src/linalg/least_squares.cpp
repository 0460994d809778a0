// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/least_squares.hpp"

#include "linalg/range_projector.hpp"
#include "linalg/threads.hpp"

#include <lapacke.h>

namespace nscdd {
namespace {

constexpr double damping = 1e-6;  // tau^2 over the largest squared length of a column
constexpr int most_iterations = 500;
constexpr int patience = 50;  // iterations without a smaller residual
constexpr double least_squares_tolerance = 1e-13;

}  // namespace

LeastSquares minimum_norm_least_squares(Matrix a, const Vector& b, double tolerance) {
  const OneBlasThread serial_blas;
  const auto rows = static_cast<lapack_int>(a.rows()), columns = static_cast<lapack_int>(a.cols());
  if (rows == 0 || columns == 0) return {.solution = Vector::Zero(a.cols())};
  Vector x = Vector::Zero(std::max(a.rows(), a.cols()));  // right-hand side in, solution out
  x.head(a.rows()) = b;
  std::vector<lapack_int> pivots(at(a.cols()), 0);
  lapack_int rank = 0;
  LAPACKE_dgelsy(LAPACK_COL_MAJOR, rows, columns, 1, a.data(), rows, x.data(), std::max(rows, columns), pivots.data(),
                 tolerance, &rank);
  return {x.head(a.cols()), rank};
}

// Once A^T (b - A x) is rounding, further steps only add components in the kernel: the best x is kept.
Vector minimum_norm_least_squares(const SparseMatrix& a, const Vector& b) {
  Vector x = Vector::Zero(a.cols()), best = x;
  double longest = 0;
  for (Index j = 0; j < a.cols(); ++j) longest = std::max(longest, a.col(j).squaredNorm());
  const SymmetricFactor factor = saddle_point_factor(a, -damping * longest);
  // y -> (A^T A + tau^2 I)^-1 y by [I A; A^T -tau^2 I] [v; z] = [0; -y].
  const auto damped = [&](const Vector& y) -> Vector {
    Vector right = Vector::Zero(a.rows() + y.size());
    right.tail(y.size()) = -y;
    return factor.solve(right).tail(y.size());
  };
  Vector s = a.transpose() * b;
  const double first = s.norm();
  if (!factor.regular() || !(first > 0)) return best;
  Vector direction = damped(s);
  double product = s.dot(direction), smallest = first;
  for (int k = 0, beaten = 0; k < most_iterations && k - beaten < patience; ++k) {
    const double curvature = (a * direction).squaredNorm();
    if (!(curvature > 0)) break;
    x += product / curvature * direction;
    s = a.transpose() * (b - a * x);
    const double size = s.norm();
    if (size < smallest) {
      smallest = size;
      best = x;
      beaten = k;
    }
    if (size <= least_squares_tolerance * first) break;
    const Vector z = damped(s);
    const double last = product;
    product = s.dot(z);
    direction = z + product / last * direction;
  }
  return best;
}

}  // namespace nscdd
