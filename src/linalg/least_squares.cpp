// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/least_squares.hpp"

#include "linalg/ldlt/saddle_point.hpp"
#include "linalg/threads.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <lapacke.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace nscdd {
namespace {

constexpr double damping = 1e-6;  // tau^2 over the largest squared length of a column
constexpr int most_iterations = 500;

// x -> (A^T A + tau^2 I)^-1 x as Eigen wants a preconditioner: [I A; A^T -tau^2 I] [v; y] = [0; -x].
class DampedInverse {
 public:
  using MatrixType = SparseMatrix;
  template <class Given>
  DampedInverse& compute(const Given& given) {
    const SparseMatrix a = given;
    double longest = 0;
    for (Index j = 0; j < a.cols(); ++j) longest = std::max(longest, a.col(j).squaredNorm());
    const SparseMatrix matrix = saddle_point(a, -damping * longest);
    rows_ = a.rows();
    factor_.emplace(saddle_point_analysis(matrix, a), matrix);
    return *this;
  }
  Vector solve(const Vector& x) const {
    Vector right = Vector::Zero(rows_ + x.size());
    right.tail(x.size()) = -x;
    return factor_->solve(right).tail(x.size());
  }
  Eigen::ComputationInfo info() const { return factor_->regular() ? Eigen::Success : Eigen::NumericalIssue; }

 private:
  Index rows_ = 0;
  std::optional<SymmetricFactor> factor_;
};

}  // namespace

LeastSquares minimum_norm_least_squares(Matrix a, const Vector& b, double tolerance) {
  const OneBlasThread serial_blas;
  const auto rows = static_cast<lapack_int>(a.rows()), columns = static_cast<lapack_int>(a.cols());
  LeastSquares result{Vector::Zero(a.cols()), 0};
  if (rows == 0 || columns == 0) return result;
  Vector x = Vector::Zero(std::max(a.rows(), a.cols()));  // right-hand side in, solution out
  x.head(a.rows()) = b;
  std::vector<lapack_int> pivots(at(a.cols()), 0);
  lapack_int rank = 0;
  LAPACKE_dgelsy(LAPACK_COL_MAJOR, rows, columns, 1, a.data(), rows, x.data(), std::max(rows, columns), pivots.data(),
                 tolerance, &rank);
  result.solution = x.head(a.cols());
  result.rank = rank;
  return result;
}

Vector minimum_norm_least_squares(const SparseMatrix& a, const Vector& b) {
  Eigen::LeastSquaresConjugateGradient<SparseMatrix, DampedInverse> solver;
  solver.setTolerance(1e-13);
  solver.setMaxIterations(most_iterations);
  solver.compute(a);
  if (solver.preconditioner().info() != Eigen::Success) return Vector::Zero(a.cols());
  return solver.solve(b);
}

}  // namespace nscdd
