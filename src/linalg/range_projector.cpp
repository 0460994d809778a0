// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/range_projector.hpp"

#include "linalg/ldlt/saddle_point.hpp"
#include "linalg/pencil.hpp"
#include "linalg/threads.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace nscdd {
namespace {

constexpr int most_refinements = 20;
// Of the vector projected: below, corrections are rounding.
constexpr double refined = 1e-15;
// Largest error of coefficients of size 1: below 1 no pivot has a false sign.
constexpr double reliable = 1e-2;
constexpr Index dense_limit = 1500;  // up to so many columns a dense spectrum decides if no factors do

std::vector<Index> filled_columns(const SparseMatrix& a) {
  std::vector<Index> filled;
  for (Index j = 0; j < a.cols(); ++j)
    if (a.col(j).norm() > 0) filled.push_back(j);
  return filled;
}

// These columns, of unit length.
SparseMatrix unit_columns(const SparseMatrix& a, const std::vector<Index>& columns) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const double norm = a.col(columns[k]).norm();
    for (SparseMatrix::InnerIterator e(a, columns[k]); e; ++e)
      entries.emplace_back(static_cast<int>(e.row()), static_cast<int>(k), e.value() / norm);
  }
  SparseMatrix b(a.rows(), count(columns));
  b.setFromTriplets(entries.begin(), entries.end());
  return b;
}

}  // namespace

class RangeProjector::Implementation {
 public:
  Implementation(const SparseMatrix& a, double tolerance)
      : rows(a.rows()), filled(filled_columns(a)), b(unit_columns(a, filled)) {
    if (b.cols() == 0) return;
    SparseMatrix matrix = saddle_point(b, 1.0);
    const SymmetricAnalysis analysis = saddle_point_analysis(matrix, b);
    // Two tolerances must agree: an eigenvalue of B^T B, or of a part of it, may lie next to one.
    std::vector<Index> counts;
    for (const double step : {3.0, 1.0, 0.3, 10.0, 0.1}) {
      matrix.diagonal().tail(b.cols()).setConstant(step * tolerance * tolerance);
      factor.emplace(analysis, matrix);
      if (!factor->regular() || !exact_enough(matrix)) continue;
      rank = factor->negative_eigenvalues();
      if (std::find(counts.begin(), counts.end(), rank) != counts.end()) return;
      counts.push_back(rank);
    }
    conclusive = false;
  }

  // [I B; B^T 0] [v; r] = [x; 0]. A part of r in ker B does not show in v.
  Vector apply(const Vector& x) const {
    if (!conclusive) return Vector::Constant(rows, not_a_number);
    if (rank == 0) return Vector::Zero(rows);
    Vector right = Vector::Zero(rows + b.cols());
    right.head(rows) = x;
    Vector solution = factor->solve(right);
    double last = infinity;
    for (int k = 0; k < most_refinements; ++k) {
      Vector residual(right.size());
      residual.head(rows) = x - solution.head(rows) - b * solution.tail(b.cols());
      residual.tail(b.cols()) = -(b.transpose() * solution.head(rows));
      const Vector correction = factor->solve(residual);
      const double size = correction.head(rows).norm();
      if (!(size < 0.5 * last)) break;
      solution += correction;
      if (size <= refined * x.norm()) break;
      last = size;
    }
    return x - solution.head(rows);
  }

  std::vector<Index> independent_columns() const {
    if (rank == 0 || !factor->regular()) return {};
    std::vector<char> dependent(at(b.cols()), 0);
    for (const Index row : factor->smallest_pivots(b.cols() - rank, rows)) dependent[at(row - rows)] = 1;
    std::vector<Index> columns;
    for (Index j = 0; j < b.cols(); ++j)
      if (!dependent[at(j)]) columns.push_back(filled[at(j)]);
    return columns;
  }

  Index rows;
  std::vector<Index> filled;  // columns of A that B has
  SparseMatrix b;
  std::optional<SymmetricFactor> factor;
  Index rank = 0;
  bool conclusive = true;

 private:
  // The pivots of dependent columns are as small as tolerance^2. Whether their signs can be relied on is
  // estimated by how well the factors give back known coefficients, one for each column.
  bool exact_enough(const SparseMatrix& matrix) const {
    Vector x = Vector::Zero(matrix.rows());
    for (Index j = 0; j < b.cols(); ++j) x[rows + j] = std::cos(1.0 + 0.7 * static_cast<double>(j));
    const Vector image = -symmetric_residual(matrix, x, Vector::Zero(x.size()));
    return (factor->solve(image) - x).lpNorm<Eigen::Infinity>() < reliable;
  }
};

RangeProjector::RangeProjector(const SparseMatrix& a, double tolerance)
    : implementation_(std::make_shared<const Implementation>(a, tolerance)) {}

Index RangeProjector::rank() const { return implementation_->rank; }
bool RangeProjector::conclusive() const { return implementation_->conclusive; }
std::vector<Index> RangeProjector::independent_columns() const { return implementation_->independent_columns(); }
Vector RangeProjector::apply(const Vector& x) const { return implementation_->apply(x); }

Index sparse_rank(const SparseMatrix& a, double tolerance) {
  const OneBlasThread serial_blas;
  const RangeProjector projector(a, tolerance);
  const RangeProjector::Implementation& sparse = *projector.implementation_;
  if (sparse.conclusive || sparse.b.cols() > dense_limit) return sparse.rank;
  const Matrix gram = Matrix(sparse.b.transpose() * sparse.b);
  return (symmetric_eigen(gram, Eigenvectors::not_wanted).values.array() > tolerance * tolerance).count();
}

}  // namespace nscdd
