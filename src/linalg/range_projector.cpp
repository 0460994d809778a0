// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/range_projector.hpp"

#include "linalg/krylov.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

#include <Eigen/QR>

namespace nscdd {
namespace {

// Largest accepted error of coefficients of size 1: below 1 no pivot has a false sign.
constexpr double reliable = 1e-2;
constexpr Index dense_limit = 1500;  // columns up to which a dense spectrum decides if no factors do
constexpr double margin = 0.3;       // of the square of the tolerance, for a clear rank
constexpr int most_refinements = 20;
constexpr double refined = 1e-15;      // smaller corrections of the projected vector are rounding
constexpr double blurred = 1e-3;       // tau for choosing columns
constexpr double faint = 1e-6;         // tau for parts outside their span
constexpr double clearly_apart = 0.1;  // from the span of others
constexpr double barely_apart = 0.02;
constexpr double least_outside = 1e-9;  // least part of a unit column outside the span of others
constexpr Index most_missing = 100;     // columns sought by random vectors
constexpr Index most_full = 30;         // columns replaced by their parts outside a span
constexpr Index oversampling = 10;      // random vectors beyond the number of missing columns
constexpr Index solved_at_once = 64;    // right-hand sides
constexpr int power_iterations = 10;

// The lower triangle of [I B; B^T D], D = diagonal I.
SparseMatrix saddle_point(const SparseMatrix& b, double diagonal) {
  SparseEntries entries;
  for (Index i = 0; i < b.rows(); ++i) entries.add(i, i, 1.0);
  for (Index j = 0; j < b.cols(); ++j) entries.add(b.rows() + j, b.rows() + j, diagonal);
  entries.add_block(b.transpose(), b.rows(), 0);
  return entries.matrix(b.rows() + b.cols(), b.rows() + b.cols());
}

SymmetricAnalysis saddle_point_analysis(const SparseMatrix& matrix, const SparseMatrix& b) {
  std::vector<Index> group(at(matrix.rows()), -1);
  std::iota(group.begin(), group.begin() + b.rows(), Index{0});
  Index next = b.rows();
  for (Index j = 0; j < b.cols(); ++j)
    if (b.col(j).nonZeros() == 0) group[at(b.rows() + j)] = next++;
  return SymmetricAnalysis(matrix, group);
}

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

// Lower bound of the largest singular value of a map, by the power method from a random vector.
double norm_of(const LinearMap& map, const LinearMap& transposed, Index columns) {
  Vector y = RandomStream(2).normal_vector(columns).normalized();
  double norm = 0;
  for (int k = 0; k < power_iterations; ++k) {
    const Vector image = map(y);
    if (!image.allFinite()) return infinity;
    norm = std::max(norm, image.norm());
    y = transposed(image);
    const double size = y.norm();
    if (!(size > 0)) break;
    y /= size;
  }
  return norm;
}

// The columns of `others` that add most to the span of those `taken`, and the distance of each from all before it.
struct Additions {
  std::vector<Index> order;
  Vector distance;
};

// Random vectors orthogonal to that span sample its complement: Q R with column exchanges of their products with
// `others` ranks the columns. After k of m random vectors are used, a distance d appears as d sqrt(m - k).
Additions additions(const SparseMatrix& taken, const SparseMatrix& others, Index wanted) {
  const SymmetricFactor factor = saddle_point_factor(taken, -faint * faint);
  if (!factor.regular()) return {};
  const Index samples = wanted + oversampling;
  RandomStream random(1);
  Matrix seen(samples, others.cols());
  for (Index first = 0; first < samples; first += solved_at_once) {
    Matrix right = Matrix::Zero(taken.rows() + taken.cols(), std::min(solved_at_once, samples - first));
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

struct ChosenBasis {
  RangeBasis basis;
  std::optional<Complement> complement;  // empty if the basis is not conclusive, or has no columns
};

// Columns are taken in three rounds.
// 1. The pivot of column j in [I B; B^T -tau^2 I] is -(tau^2 + d_j^2), d_j its distance from the span of the columns
//    before it (without directions below tau). All columns that are clearly apart are taken.
// 2. Of the others those that add most, as long as they clearly add something.
// 3. For the missing directions, the parts of columns outside the span of all columns taken.
// With the columns of B in the order [B_1 B_2], B_1 independent, the space of the singular values that count is tilted
// against the span of B_1 by at most the norm of the part of B_2 outside it, over the smallest singular value of B_1.
// With parts of columns the latter is about the product of their smallest length and that of whole columns.
ChosenBasis choose_basis(CountedRank rank, Tilt tilt) {
  const SparseMatrix& b = rank.b;
  ChosenBasis result{{.columns = {}, .others = Matrix(b.rows(), 0), .conclusive = rank.conclusive && rank.clear}, {}};
  RangeBasis& basis = result.basis;
  if (rank.value == 0) return result;
  const ChosenBasis inconclusive{{.columns = {}, .others = result.basis.others, .conclusive = false}, {}};
  if (!rank.factor->regular()) return inconclusive;
  rank.factor.emplace(*rank.analysis, saddle_point(b, -blurred * blurred));
  if (!rank.factor->regular()) return inconclusive;
  const Vector apart = (-rank.factor->pivots().tail(b.cols())).cwiseMax(0.0).cwiseSqrt();
  rank.factor.reset();
  rank.analysis.reset();
  std::vector<Index> order = natural_order(b.cols());
  std::stable_sort(order.begin(), order.end(), [&](Index i, Index j) { return apart[i] > apart[j]; });
  const auto last = order.begin() + rank.value;
  auto unclear = std::find_if(order.begin(), last, [&](Index j) { return !(apart[j] > clearly_apart); });
  while (last - unclear > most_missing && apart[*unclear] > barely_apart) ++unclear;
  std::vector<Index> taken(order.begin(), unclear), others(unclear, order.end()), weak;
  if (const Index missing = rank.value - count(taken); missing > 0) {
    const Additions more = additions(selected_columns(b, taken), selected_columns(b, others), missing);
    if (count(more.order) < missing) return inconclusive;
    for (Index k = 0; k < missing; ++k)
      (more.distance[k] > barely_apart || missing - k > most_full ? taken : weak)
          .push_back(others[at(more.order[at(k)])]);
  }
  for (const Index j : taken) basis.columns.push_back(rank.filled[at(j)]);
  std::sort(basis.columns.begin(), basis.columns.end());
  if (weak.empty() && rank.value == b.cols()) return result;
  Complement& complement = result.complement.emplace(selected_columns(b, taken));
  if (!complement.regular()) return inconclusive;
  double least = 1;
  for (const Index j : weak) {
    Vector own = complement.apply(b.col(j));
    least = std::min(least, own.norm());
    own = complement.apply(own.normalized());
    complement.leave_out(own.normalized());
  }
  basis.others = complement.others();
  // Shorter parts are rounding.
  basis.conclusive &= basis.others.allFinite() && least > least_outside;
  if (tilt == Tilt::measured) {
    basis.tilt = complement.pseudo_inverse_norm() / least *
                 norm_of([&](const Vector& y) { return complement.apply(b * y); },
                         [&](const Vector& x) -> Vector { return b.transpose() * x; }, b.cols());
    if (!std::isfinite(basis.tilt)) basis.tilt = infinity;
  }
  return result;
}

}  // namespace

SymmetricFactor saddle_point_factor(const SparseMatrix& b, double diagonal) {
  const SparseMatrix matrix = saddle_point(b, diagonal);
  return SymmetricFactor(saddle_point_analysis(matrix, b), matrix);
}

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

// Pivots of dependent columns are as small as tolerance^2. A solve for known coefficients checks their signs.
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

RangeBasis range_basis(const SparseMatrix& a, Tilt tilt) { return choose_basis(CountedRank(a), tilt).basis; }

Complement::Complement(SparseMatrix b, std::optional<SymmetricFactor> factor)
    : b_(std::move(b)),
      factor_(factor ? std::move(*factor) : saddle_point_factor(b_, -faint * faint)),
      others_(b_.rows(), 0) {}

void Complement::leave_out(const Vector& unit) {
  others_.conservativeResize(Eigen::NoChange, others_.cols() + 1);
  others_.rightCols(1) = unit;
}

Vector Complement::apply(const Vector& x) const {
  const Index rows = b_.rows();
  Vector right = Vector::Zero(rows + b_.cols());
  right.head(rows) = x;
  Vector solution = factor_.solve(right);
  double last = infinity;
  for (int k = 0; k < most_refinements; ++k) {
    Vector residual(right.size());
    residual.head(rows) = x - solution.head(rows) - b_ * solution.tail(b_.cols());
    residual.tail(b_.cols()) = -(b_.transpose() * solution.head(rows));
    const Vector correction = factor_.solve(residual);
    const double size = correction.head(rows).norm();
    if (!(size < 0.5 * last)) break;
    solution += correction;
    if (size <= refined * x.norm()) break;
    last = size;
  }
  const Vector outside = solution.head(rows);
  return outside - others_ * (others_.transpose() * outside);
}

// [I B; B^T t I] [v; r] = [x; y] has r = B^+ x for y = 0, and v = (B^+)^T y for x = 0, short of t.
double Complement::pseudo_inverse_norm() const {
  const Index rows = b_.rows();
  const auto solve = [&](const Vector& x, const Vector& y) {
    Vector right(rows + b_.cols());
    right << x, y;
    return factor_.solve(right);
  };
  return norm_of([&](const Vector& x) -> Vector { return solve(x, Vector::Zero(b_.cols())).tail(b_.cols()); },
                 [&](const Vector& y) -> Vector { return solve(Vector::Zero(rows), y).head(rows); }, rows);
}

RangeProjector::RangeProjector(const SparseMatrix& a, double tolerance, Tilt tilt) {
  CountedRank rank(a, tolerance);
  rank_ = rank.value;
  conclusive_ = rank.conclusive;
  if (!rank.conclusive || !rank.clear) tilt_ = infinity;
  if (rank_ == 0 || !conclusive_) return;
  if (rank_ == rank.b.cols()) {
    complement_.emplace(std::move(rank.b), std::move(rank.factor));
    return;
  }
  ChosenBasis chosen = choose_basis(std::move(rank), tilt);
  conclusive_ = chosen.complement.has_value();
  tilt_ = chosen.basis.conclusive ? chosen.basis.tilt : infinity;
  complement_ = std::move(chosen.complement);
}

Vector RangeProjector::apply(const Vector& x) const {
  if (!conclusive_) return Vector::Constant(x.size(), not_a_number);
  if (rank_ == 0) return Vector::Zero(x.size());
  return x - complement_->apply(x);
}

}  // namespace nscdd
