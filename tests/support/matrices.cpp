// SPDX-License-Identifier: GPL-3.0-or-later
#include "matrices.hpp"

#include <nscdd/linalg/inertia_factor.hpp>

#include <algorithm>
#include <cmath>

namespace nscdd::testing {
namespace {

// About `density` x n entries per column off the diagonal, which is sign x (4 + something).
Matrix random_symmetric(Index n, double density, bool definite, std::uint64_t seed) {
  RandomStream random(seed);
  Matrix a = Matrix::Zero(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = j + 1; i < n; ++i)
      if (random.uniform() < density) a(i, j) = a(j, i) = random.normal();
  for (Index i = 0; i < n; ++i) {
    const double dominant = a.col(i).cwiseAbs().sum() + 0.5;
    a(i, i) = definite ? dominant : (random.uniform() < 0.5 ? -1 : 1) * dominant;
  }
  return a;
}

}  // namespace

Dense random_matrix(Index rows, Index columns, std::uint64_t seed) {
  RandomStream random(seed);
  return random_matrix(rows, columns, random);
}

Dense random_matrix(Index rows, Index columns, RandomStream& random) {
  Matrix a(rows, columns);
  for (Index j = 0; j < columns; ++j) a.col(j) = random.normal_vector(rows);
  return a;
}

Dense random_orthogonal(Index n, std::uint64_t seed) { return orthogonal_factor(random_matrix(n, n, seed)); }

KnownPencil::KnownPencil(const Vector& eigenvalues, std::uint64_t seed) {
  const Index n = eigenvalues.size();
  Matrix lower = random_matrix(n, n, seed).entries().triangularView<Eigen::Lower>();
  lower.diagonal().array() = lower.diagonal().array().abs() + 2.0 * std::sqrt(static_cast<double>(n));
  const Dense l = lower, q = random_orthogonal(n, seed + 1);
  a = l * q * diagonal(eigenvalues) * q.transpose() * l.transpose();
  a = 0.5 * (a + a.transpose());
  p = l * l.transpose();
}

LinearMap map_of(const Dense& a) {
  return [a](const Vector& x) -> Vector { return a * x; };
}

LinearMap shifted_inverse(const KnownPencil& pencil, double sigma) { return solver(pencil.a - sigma * pencil.p); }

Matrix full(const SparseMatrix& lower) { return Matrix(lower).selfadjointView<Eigen::Lower>(); }

SparseMatrix lower_triangle(const Matrix& full) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < full.cols(); ++j)
    for (Index i = j; i < full.rows(); ++i)
      if (i == j || full(i, j) != 0) entries.emplace_back(i, j, full(i, j));
  SparseMatrix lower(full.rows(), full.cols());
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

std::vector<Index> single_rows(Index n) { return natural_order(n); }

SymmetricProblem saddle_point(Index pairs, double first, double last, std::uint64_t seed) {
  RandomStream random(seed);
  const Index k = 2 * pairs, n = k + pairs;
  Matrix a = Matrix::Zero(n, n);
  std::vector<Index> group(at(n));
  for (Index i = 0; i < pairs; ++i) {
    a(2 * i, 2 * i) = first;
    a(2 * i + 1, 2 * i + 1) = first;
    a(k + i, 2 * i) = 1;
    a(k + i, 2 * i + 1) = -1;
    a(k + i, k + i) = -last;
    group[at(2 * i)] = group[at(2 * i + 1)] = group[at(k + i)] = i;
  }
  for (Index link = 0; link < 2 * k; ++link) {  // graph Laplacian of random links: semidefinite
    const Index i = random.below(k), j = random.below(k);
    if (i == j) continue;
    const double stiffness = 0.5 + random.uniform();
    a(i, i) += stiffness;
    a(j, j) += stiffness;
    a(std::max(i, j), std::min(i, j)) -= stiffness;
  }
  return {"saddle point", lower_triangle(a), group};
}

std::vector<SymmetricProblem> every_symmetric_problem() {
  std::vector<SymmetricProblem> all;
  const auto add = [&](const std::string& name, const Matrix& a) {
    all.push_back({name, lower_triangle(a), single_rows(a.rows())});
  };
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    add("sparse definite", random_symmetric(150, 0.02, true, seed));
    add("sparse indefinite", random_symmetric(150, 0.02, false, seed));
    all.push_back(saddle_point(40, 0.5, 0.7, seed));
    all.push_back(saddle_point(40, 0.5, 0.0, seed));
    all.push_back(saddle_point(40, -0.3, 0.0, seed));  // indefinite without its multipliers
  }
  // Dense without a dominant diagonal, all rows one group: 2 x 2 pivots, more columns than a panel is wide.
  for (const Index n : {2, 3, 40, 200}) {
    const Dense random = random_matrix(n, n, 5);
    Matrix a = random + random.transpose();
    a.diagonal() *= 0.1;
    all.push_back({"dense", lower_triangle(a), std::vector<Index>(at(n), 0)});
  }
  // Groups of five rows, chained, with diagonal blocks that only pivoting inside a group can factorise.
  Matrix chain = Matrix::Zero(300, 300);
  for (Index group = 0; group < 60; ++group) {
    const Dense random = random_matrix(5, 5, 100 + static_cast<std::uint64_t>(group));
    chain.block(5 * group, 5 * group, 5, 5) = (random + random.transpose()).entries();
    chain.block(5 * group, 5 * group, 5, 5).diagonal().setZero();
    if (group > 0) chain(5 * group, 5 * group - 1) = chain(5 * group - 1, 5 * group) = 0.3;
  }
  SymmetricProblem chained{"chain of groups with empty diagonals", lower_triangle(chain), {}};
  for (Index i = 0; i < 300; ++i) chained.group.push_back(i / 5);
  all.push_back(chained);
  Matrix arrow = Vector::LinSpaced(80, -4, 4).asDiagonal();
  arrow.row(0).setOnes();
  arrow.col(0).setOnes();
  add("arrow pointing up", arrow);
  add("arrow pointing down", arrow.reverse());
  add("diagonal", Vector::LinSpaced(30, -1.5, 2.0).asDiagonal());
  add("one row", Matrix::Constant(1, 1, -2.5));
  Matrix blocks = Matrix::Zero(90, 90);
  blocks.topLeftCorner(30, 30) = random_symmetric(30, 0.2, false, 7);
  blocks.block(30, 30, 40, 40) = random_symmetric(40, 0.1, true, 8);
  blocks.bottomRightCorner(20, 20) = -random_symmetric(20, 0.3, true, 9);
  add("disconnected blocks", blocks);
  return all;
}

SparseMatrix shifted_laplacian(Index columns, Index rows, double shift) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < rows; ++j)
    for (Index i = 0; i < columns; ++i) {
      const Index k = j * columns + i;
      entries.emplace_back(k, k, 4 - shift);
      if (i + 1 < columns) entries.emplace_back(k + 1, k, -1.0);
      if (j + 1 < rows) entries.emplace_back(k + columns, k, -1.0);
    }
  SparseMatrix lower(columns * rows, columns * rows);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

double backward_error(const SparseMatrix& lower, const Vector& x, const Vector& b) {
  if (!x.allFinite()) return infinity;
  const Vector residual = symmetric_residual(lower, x, b);
  const Vector size = -symmetric_residual(lower.cwiseAbs(), x.cwiseAbs(), -b.cwiseAbs());  // |A| |x| + |b|
  double worst = 0;
  for (Index i = 0; i < b.size(); ++i)
    if (size[i] > 0) worst = std::max(worst, std::abs(residual[i]) / size[i]);
  return worst;
}

}  // namespace nscdd::testing
