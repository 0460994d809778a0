// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/linalg/least_squares.hpp>

#include <lapacke.h>

#include <algorithm>
#include <vector>

namespace nscdd {

LeastSquares minimum_norm_least_squares(Matrix a, const Vector& b, double tolerance) {
  const auto rows = static_cast<lapack_int>(a.rows()), columns = static_cast<lapack_int>(a.cols());
  LeastSquares result{Vector::Zero(a.cols()), 0};
  if (rows == 0 || columns == 0) return result;
  Vector x = Vector::Zero(std::max(a.rows(), a.cols()));  // right-hand side in, solution out
  x.head(a.rows()) = b;
  std::vector<lapack_int> pivots(at(a.cols()), 0);
  lapack_int rank = 0;
  LAPACKE_dgelsy(LAPACK_COL_MAJOR, rows, columns, 1, a.data(), rows, x.data(), std::max(rows, columns),
                 pivots.data(), tolerance, &rank);
  result.solution = x.head(a.cols());
  result.rank = rank;
  return result;
}

}  // namespace nscdd
