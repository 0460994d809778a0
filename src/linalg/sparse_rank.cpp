// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_rank.hpp"

#include "linalg/pencil.hpp"
#include "linalg/saddle_point.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

namespace nscdd {
namespace {

// Largest accepted error of coefficients of size 1: below 1 no pivot has a false sign.
constexpr double reliable = 1e-2;
constexpr Index dense_limit = 1500;  // columns up to which a dense spectrum decides if no factors do
constexpr double margin = 0.3;       // of the square of the tolerance, for a clear rank

std::vector<Index> filled_columns(const SparseMatrix& a) {
  std::vector<Index> filled;
  for (Index j = 0; j < a.cols(); ++j)
    if (a.col(j).norm() > 0) filled.push_back(j);
  return filled;
}

SparseMatrix with_unit_columns(SparseMatrix a) {
  for (Index j = 0; j < a.cols(); ++j) a.col(j) /= a.col(j).norm();
  return a;
}

}  // namespace

CountedRank::CountedRank(const SparseMatrix& a, double tolerance)
    : filled(filled_columns(a)), b(with_unit_columns(selected_columns(a, filled))) {
  if (b.cols() == 0) return;
  SparseMatrix matrix = saddle_point(b, 1.0);
  analysis.emplace(saddle_point_analysis(matrix, b));
  // Two tolerances must agree: an eigenvalue of B^T B, or of a part of it, may lie next to one.
  std::vector<Index> counts;
  for (const double step : {1 / margin, margin, 1.0, 10.0, 0.1}) {
    matrix.diagonal().tail(b.cols()).setConstant(step * tolerance * tolerance);
    factor.emplace(*analysis, matrix);
    if (!factor->regular() || !exact_enough(matrix)) continue;
    const Index last = std::exchange(value, factor->negative_eigenvalues());
    if (step == margin && !counts.empty()) clear = value == last;
    if (std::find(counts.begin(), counts.end(), value) != counts.end()) return;
    counts.push_back(value);
  }
  conclusive = false;
}

// The pivots of dependent columns are as small as tolerance^2. The reliability of their signs is estimated by solving
// for known coefficients, one for each column.
bool CountedRank::exact_enough(const SparseMatrix& matrix) const {
  Vector x = Vector::Zero(matrix.rows());
  for (Index j = 0; j < b.cols(); ++j) x[b.rows() + j] = std::cos(1.0 + 0.7 * static_cast<double>(j));
  const Vector image = -symmetric_residual(matrix, x, Vector::Zero(x.size()));
  return (factor->solve(image) - x).lpNorm<Eigen::Infinity>() < reliable;
}

MatrixRank sparse_rank(const SparseMatrix& a, double tolerance) {
  const OneBlasThread serial_blas;
  const CountedRank sparse(a, tolerance);
  if (sparse.conclusive || sparse.b.cols() > dense_limit) return {sparse.value, sparse.conclusive && sparse.clear};
  const Matrix gram = Matrix(sparse.b.transpose() * sparse.b);
  const Vector squares = symmetric_eigen(gram, Eigenvectors::not_wanted).values;
  const auto above = [&](double bound) { return (squares.array() > bound * bound).count(); };
  return {above(tolerance),
          squares.allFinite() && above(std::sqrt(margin) * tolerance) == above(tolerance / std::sqrt(margin))};
}

}  // namespace nscdd
