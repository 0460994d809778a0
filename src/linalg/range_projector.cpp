// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/range_projector.hpp"

#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

#include <Eigen/QR>
#include <lapacke.h>

#include <numeric>

namespace nscdd {
namespace {

constexpr int most_refinements = 20;
// Of the vector projected: below, corrections are rounding.
constexpr double refined = 1e-15;
// Largest error of coefficients of size 1: below 1 no pivot has a false sign.
constexpr double reliable = 1e-2;
constexpr Index dense_limit = 1500;    // up to so many columns a dense spectrum decides if no factors do
constexpr double margin = 0.3;         // of the tolerance, where a rank is clear
constexpr double blurred = 1e-3;       // tau where columns are chosen
constexpr double faint = 1e-6;         // tau where that is wanted which is outside their span
constexpr double clearly_apart = 0.1;  // from the span of others
constexpr double barely_apart = 0.02;
constexpr double least_outside = 1e-9;  // of a column of unit length that is in no span of others
constexpr Index most_missing = 100;     // columns that are sought by random vectors, of those that are barely apart
constexpr Index most_full = 30;         // columns that are replaced by their parts outside a span
constexpr Index oversampling = 10;      // random vectors beyond as many as there are columns to be found
constexpr Index solved_at_once = 64;    // right-hand sides
constexpr double damping = 1e-6;        // tau^2 over the largest squared length of a column
constexpr int most_iterations = 500;
constexpr int patience = 50;  // iterations without a smaller residual
constexpr double least_squares_tolerance = 1e-13;

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

// Lower triangle of [I B; B^T diagonal I].
SparseMatrix saddle_point(const SparseMatrix& b, double diagonal) {
  SparseEntries entries;
  for (Index i = 0; i < b.rows(); ++i) entries.add(i, i, 1.0);
  for (Index j = 0; j < b.cols(); ++j) entries.add(b.rows() + j, b.rows() + j, diagonal);
  entries.add_block(b.transpose(), b.rows(), 0);
  return entries.matrix(b.rows() + b.cols(), b.rows() + b.cols());
}

// The analysis of such a matrix. The multiplier of a column of B is eliminated with the last of the rows that it ties.
SymmetricAnalysis saddle_point_analysis(const SparseMatrix& matrix, const SparseMatrix& b) {
  std::vector<Index> group(at(matrix.rows()), -1);
  std::iota(group.begin(), group.begin() + b.rows(), Index{0});
  Index next = b.rows();
  for (Index j = 0; j < b.cols(); ++j)
    if (b.col(j).nonZeros() == 0) group[at(b.rows() + j)] = next++;
  return SymmetricAnalysis(matrix, group);
}

// x -> (A^T A + tau^2 I)^-1 x by [I A; A^T -tau^2 I] [v; y] = [0; -x].
class DampedInverse {
 public:
  explicit DampedInverse(const SparseMatrix& a) : rows_(a.rows()) {
    double longest = 0;
    for (Index j = 0; j < a.cols(); ++j) longest = std::max(longest, a.col(j).squaredNorm());
    const SparseMatrix matrix = saddle_point(a, -damping * longest);
    factor_.emplace(saddle_point_analysis(matrix, a), matrix);
  }
  Vector operator()(const Vector& x) const {
    Vector right = Vector::Zero(rows_ + x.size());
    right.tail(x.size()) = -x;
    return factor_->solve(right).tail(x.size());
  }
  bool regular() const { return factor_->regular(); }

 private:
  Index rows_ = 0;
  std::optional<SymmetricFactor> factor_;
};

// The columns of `others` in the order in which they add most to the span of the columns `taken`, as many as are
// wanted, and by how much each does: its distance from the span of all before it, about.
struct Additions {
  std::vector<Index> order;
  Vector distance;
};

// What lies outside that span is seen by a few random vectors of the space that is orthogonal to it: Q R with column
// exchanges on their products with `others` tells what adds most. Of m random vectors, k of which the columns before
// have taken up, the others see a distance d as d sqrt(m - k).
Additions additions(const SparseMatrix& taken, const SparseMatrix& others, Index wanted) {
  const SparseMatrix matrix = saddle_point(taken, -faint * faint);
  const SymmetricFactor factor(saddle_point_analysis(matrix, taken), matrix);
  if (!factor.regular()) return {};
  const Index samples = wanted + oversampling;
  RandomStream random(1);
  Matrix seen(samples, others.cols());
  for (Index first = 0; first < samples; first += solved_at_once) {
    Matrix right = Matrix::Zero(matrix.rows(), std::min(solved_at_once, samples - first));
    for (Index k = 0; k < right.cols(); ++k) right.col(k).head(taken.rows()) = random.normal_vector(taken.rows());
    const Matrix outside = factor.solve_columns(std::move(right)).topRows(taken.rows());
    seen.middleRows(first, outside.cols()) = (others.transpose() * outside).transpose();
  }
  const Eigen::ColPivHouseholderQR<Matrix> factors(std::move(seen));
  const auto& order = factors.colsPermutation().indices();
  Additions result{{order.data(), order.data() + wanted}, Vector(wanted)};
  for (Index k = 0; k < wanted; ++k)
    result.distance[k] = std::abs(factors.matrixQR()(k, k)) / std::sqrt(static_cast<double>(samples - k));
  return result;
}

}  // namespace

RangeProjector::RangeProjector(const SparseMatrix& a, double tolerance)
    : rows_(a.rows()), filled_(filled_columns(a)), b_(with_unit_columns(selected_columns(a, filled_))) {
  if (b_.cols() == 0) return;
  SparseMatrix matrix = saddle_point(b_, 1.0);
  analysis_.emplace(saddle_point_analysis(matrix, b_));
  // Two tolerances must agree: an eigenvalue of B^T B, or of a part of it, may lie next to one.
  std::vector<Index> counts;
  for (const double step : {1 / margin, margin, 1.0, 10.0, 0.1}) {
    matrix.diagonal().tail(b_.cols()).setConstant(step * tolerance * tolerance);
    factor_.emplace(*analysis_, matrix);
    if (!factor_->regular() || !exact_enough(matrix)) continue;
    const Index last = std::exchange(rank_, factor_->negative_eigenvalues());
    if (step == margin && !counts.empty()) clear_ = rank_ == last;
    if (std::find(counts.begin(), counts.end(), rank_) != counts.end()) return;
    counts.push_back(rank_);
  }
  conclusive_ = false;
}

// The pivots of dependent columns are as small as tolerance^2. Whether their signs can be relied on is estimated by how
// well the factors give back known coefficients, one for each column.
bool RangeProjector::exact_enough(const SparseMatrix& matrix) const {
  Vector x = Vector::Zero(matrix.rows());
  for (Index j = 0; j < b_.cols(); ++j) x[rows_ + j] = std::cos(1.0 + 0.7 * static_cast<double>(j));
  const Vector image = -symmetric_residual(matrix, x, Vector::Zero(x.size()));
  return (factor_->solve(image) - x).lpNorm<Eigen::Infinity>() < reliable;
}

// [I B; B^T 0] [v; r] = [x; 0]. A part of r in ker B does not show in v.
Vector RangeProjector::apply(const Vector& x) const {
  if (!conclusive_) return Vector::Constant(rows_, not_a_number);
  if (rank_ == 0) return Vector::Zero(rows_);
  Vector right = Vector::Zero(rows_ + b_.cols());
  right.head(rows_) = x;
  Vector solution = factor_->solve(right);
  double last = infinity;
  for (int k = 0; k < most_refinements; ++k) {
    Vector residual(right.size());
    residual.head(rows_) = x - solution.head(rows_) - b_ * solution.tail(b_.cols());
    residual.tail(b_.cols()) = -(b_.transpose() * solution.head(rows_));
    const Vector correction = factor_->solve(residual);
    const double size = correction.head(rows_).norm();
    if (!(size < 0.5 * last)) break;
    solution += correction;
    if (size <= refined * x.norm()) break;
    last = size;
  }
  return x - solution.head(rows_);
}

// Columns are taken in three rounds.
// 1. The pivot of column j in [I B; B^T -tau^2 I] is -(tau^2 + d_j^2), d_j its distance from the span of the columns
//    before it (short of directions that these have by less than tau). All columns that are clearly apart are taken.
// 2. Of the others those that add most, as long as they add something clear.
// 3. What is still missing is in the range by little: the parts of columns outside the span of all that are taken.
RangeBasis RangeProjector::basis() const {
  RangeBasis result{.columns = {}, .others = Matrix(rows_, 0), .conclusive = conclusive_ && clear_};
  if (rank_ == 0 || !factor_->regular()) return result;
  const SymmetricFactor blurred_factor(*analysis_, saddle_point(b_, -blurred * blurred));
  if (!blurred_factor.regular()) return {.columns = {}, .others = Matrix(rows_, 0), .conclusive = false};
  const Vector apart = (-blurred_factor.pivots().tail(b_.cols())).cwiseMax(0.0).cwiseSqrt();
  std::vector<Index> order(at(b_.cols()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index i, Index j) { return apart[i] > apart[j]; });
  const auto last = order.begin() + rank_;
  auto unclear = std::find_if(order.begin(), last, [&](Index j) { return !(apart[j] > clearly_apart); });
  while (last - unclear > most_missing && apart[*unclear] > barely_apart) ++unclear;
  std::vector<Index> taken(order.begin(), unclear), others(unclear, order.end()), weak;
  if (const Index missing = rank_ - count(taken); missing > 0) {
    const Additions more = additions(selected_columns(b_, taken), selected_columns(b_, others), missing);
    result.conclusive &= count(more.order) == missing;
    for (Index k = 0; k < count(more.order); ++k)
      (more.distance[k] > barely_apart || missing - k > most_full ? taken : weak)
          .push_back(others[at(more.order[at(k)])]);
  }
  if (!weak.empty()) {
    const RangeProjector span(selected_columns(b_, taken));
    result.conclusive &= span.conclusive();
    result.others = Matrix(selected_columns(b_, weak));
    for (int round = 0; round < 2; ++round)
      for (Index k = 0; k < result.others.cols(); ++k) {
        auto own = result.others.col(k);
        own -= span.apply(own);
        own -= result.others.leftCols(k) * (result.others.leftCols(k).transpose() * own);
        result.conclusive &= own.norm() > least_outside;  // else it would be rounding, and no part of the range
        own.normalize();
      }
  }
  for (const Index j : taken) result.columns.push_back(filled_[at(j)]);
  std::sort(result.columns.begin(), result.columns.end());
  return result;
}

MatrixRank sparse_rank(const SparseMatrix& a, double tolerance) {
  const OneBlasThread serial_blas;
  const RangeProjector sparse(a, tolerance);
  if (sparse.conclusive_ || sparse.b_.cols() > dense_limit) return {sparse.rank_, sparse.clear_};
  const Matrix gram = Matrix(sparse.b_.transpose() * sparse.b_);
  const Vector squares = symmetric_eigen(gram, Eigenvectors::not_wanted).values;
  const auto above = [&](double bound) { return (squares.array() > bound * bound).count(); };
  return {above(tolerance), above(margin * tolerance) == above(tolerance / margin)};
}

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
  return {x.head(a.cols()), rank};
}

// Conjugate gradients on A^T A x = A^T b. Once A^T (b - A x) is rounding, further steps only grow what lies in the
// kernel of A: the x with the smallest of these residuals is kept, and the steps end where it is not beaten any more.
Vector minimum_norm_least_squares(const SparseMatrix& a, const Vector& b) {
  Vector x = Vector::Zero(a.cols()), best = x;
  const DampedInverse damped(a);
  Vector s = a.transpose() * b;
  const double first = s.norm();
  if (!damped.regular() || !(first > 0)) return best;
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
