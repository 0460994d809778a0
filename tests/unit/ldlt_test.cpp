// SPDX-License-Identifier: GPL-3.0-or-later
// The multifrontal L D L^T factorisation against dense algebra: inertia, solves, blocks of the inverse.
#include "../support/matrices.hpp"
#include "linalg/multifrontal/factor.hpp"
#include "linalg/multifrontal/fronts.hpp"
#include "linalg/random.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Index negative_count(const Dense& a) { return (symmetric_eigenvalues(a).array() < 0).count(); }

SymmetricFactor factorise(const SymmetricProblem& problem, const std::vector<char>& last = {}) {
  return {SymmetricAnalysis(problem.lower, problem.group, {.last = last, .kept = {}}), problem.lower};
}

// A_kk - A_ke A_ee^-1 A_ke^T.
Matrix schur_complement(const Matrix& a_kk, const Matrix& a_ke, const Matrix& a_ee) {
  if (a_ee.rows() == 0 || a_kk.rows() == 0) return a_kk;
  return Dense(a_kk) - Dense(a_ke) * solve(Dense(a_ee), Dense(a_ke).transpose());
}

double largest(const Matrix& a) { return a.cwiseAbs().maxCoeff(); }

// A factor of a matrix with the inertia of `a`, which solves for b.
void check_factor(const SymmetricFactor& factor, const SparseMatrix& lower, const Dense& a, const Vector& b,
                  double tolerance = 1e-11) {
  REQUIRE(factor.regular());
  CHECK(factor.negative_eigenvalues() == negative_count(a));
  CHECK(backward_error(lower, factor.solve(b), b) < tolerance);
}

// Elimination is backward stable: where rounding leaves a last pivot of its own size instead of none, the
// solution is that of a regular matrix next to A, and grows to some 1/rounding.
bool singular_shows(const SymmetricFactor& factor, const SparseMatrix& lower, const Vector& b) {
  if (!factor.regular()) return true;
  const Vector x = factor.solve(b);
  return !(backward_error(lower, x, b) < 1e-3) || largest(x) > 1e10 * largest(b);
}

// Some rows in no particular order, the first and the last among them.
std::vector<Index> some_rows(Index n) {
  std::vector<Index> rows{n - 1};
  for (Index i = 1; i < n - 1; i += 7) rows.push_back(i);
  if (n > 1) rows.push_back(0);
  return rows;
}

}  // namespace

TEST_CASE("symmetric factor: inertia, solve and inverse blocks of every shape of matrix") {
  for (const SymmetricProblem& problem : every_symmetric_problem()) {
    CAPTURE(problem.name);
    const Dense a = full(problem.lower);
    const Index n = a.rows();
    CAPTURE(n);
    const SymmetricAnalysis analysis(problem.lower, problem.group);
    CHECK(analysis.entries() >= static_cast<double>(problem.lower.nonZeros()));
    CHECK(analysis.entries() <= static_cast<double>(n * (n + 1) / 2));
    const SymmetricFactor factor(analysis, problem.lower);
    REQUIRE(factor.regular());
    CHECK(factor.negative_eigenvalues() == negative_count(a));
    const Dense inverse = a.inverse();
    for (const std::uint64_t seed : {1U, 2U}) {
      const Vector b = RandomStream(seed).normal_vector(n);
      const Vector x = factor.solve(b);
      CHECK(backward_error(problem.lower, x, b) < 1e-11);
      CHECK(largest(x - inverse * b) < 1e-9 * largest(inverse) * largest(b));
    }
    const std::vector<Index> rows = some_rows(n);
    CHECK(largest(factor.inverse_block(rows) - inverse.entries()(rows, rows)) < 1e-9 * largest(inverse));
  }
}

TEST_CASE("symmetric factor: saddle points have the inertia of theory") {
  // K definite: n positive eigenvalues, and A K^-1 A^T + C definite: as many negative ones as multipliers.
  for (const double c : {0.0, 1e-3, 2.0}) CHECK(factorise(saddle_point(60, 1.0, c, 4)).negative_eigenvalues() == 60);
}

TEST_CASE("symmetric factor: one analysis serves every matrix of its pattern") {
  const SymmetricProblem first = saddle_point(50, 0.5, 0.7, 11);
  const SymmetricAnalysis analysis(first.lower, first.group);
  for (const double shift : {0.0, 0.4, 1.3, 2.9, 6.0, -3.0}) {
    CAPTURE(shift);
    SparseMatrix lower = first.lower;
    for (Index i = 0; i < lower.rows(); ++i) lower.coeffRef(i, i) -= shift;
    check_factor({analysis, lower}, lower, full(lower), Vector::LinSpaced(lower.rows(), -1, 1));
  }
}

TEST_CASE("symmetric factor: results do not depend on how groups are numbered") {
  const SymmetricProblem one = saddle_point(50, -0.3, 0.0, 12);
  SymmetricProblem other = one;
  for (Index& g : other.group) g = (7 * g + 3) % 50;
  const SymmetricFactor a = factorise(one), b = factorise(other);
  CHECK(a.negative_eigenvalues() == b.negative_eigenvalues());
  const Vector right = RandomStream(3).normal_vector(one.lower.rows());
  CHECK(largest(a.solve(right) - b.solve(right)) < 1e-10 * largest(a.solve(right)));
}

TEST_CASE("symmetric factor: groups eliminated last, and the inverse on their rows") {
  for (const SymmetricProblem& problem :
       {saddle_point(60, 0.5, 0.7, 21), saddle_point(60, -0.3, 0.0, 22),
        SymmetricProblem{"Laplacian", shifted_laplacian(14, 11, 1.7), single_rows(154)}}) {
    CAPTURE(problem.name);
    const Index groups = *std::max_element(problem.group.begin(), problem.group.end()) + 1;
    for (const Index stride : {1, 2, 9, 1000}) {  // all last, every other one, few, one
      CAPTURE(stride);
      std::vector<char> last(at(groups), 0);
      for (Index g = 0; g < groups; g += stride) last[at(g)] = 1;
      const SymmetricFactor factor = factorise(problem, last);
      const Dense a = full(problem.lower), inverse = a.inverse();
      check_factor(factor, problem.lower, a, Vector::Ones(a.rows()));
      std::vector<Index> rows;
      for (Index i = a.rows() - 1; i >= 0; --i)
        if (last[at(problem.group[at(i)])]) rows.push_back(i);
      const Matrix block = factor.inverse_block(rows);
      CHECK(largest(block - inverse.entries()(rows, rows)) < 1e-9 * largest(inverse));
      CHECK(largest(block - block.transpose()) < 1e-9 * largest(inverse));
    }
  }
}

TEST_CASE("symmetric factor: the groups of a chain of parts are eliminated last, segment by segment from both ends") {
  // Four parts of a strip and three cuts between them, three nodes wide, numbered row by row.
  const Index columns = 15, rows = 3;
  Graph graph;
  std::vector<char> last;
  for (Index node = 0; node < columns * rows; ++node) {
    const Index x = node % columns, y = node / columns;
    last.push_back(x % 4 == 3);
    if (y > 0) graph.neighbours.push_back(static_cast<int>(node - columns));
    if (x > 0) graph.neighbours.push_back(static_cast<int>(node - 1));
    if (x + 1 < columns) graph.neighbours.push_back(static_cast<int>(node + 1));
    if (y + 1 < rows) graph.neighbours.push_back(static_cast<int>(node + columns));
    graph.start.push_back(static_cast<int>(graph.neighbours.size()));
  }
  const std::vector<int> weight(last.size(), 2);
  CHECK(order_of_last(graph, weight, last) == std::vector<int>{3, 18, 33, 11, 26, 41, 7, 22, 37});
}

TEST_CASE("symmetric factor: what is apart from the border serves a family, to the bit") {
  for (const Index stride : {1, 5, 40, 1000}) {
    CAPTURE(stride);
    const SymmetricProblem problem = saddle_point(60, 0.5, 0.7, 31);
    const Index n = problem.lower.rows();
    std::vector<Index> border;
    for (Index i = n - 1; i >= 0; i -= stride) border.push_back(i);
    std::vector<char> on_border(at(n), 0);
    for (const Index i : border) on_border[at(i)] = 1;
    const SymmetricAnalysis analysis(problem.lower, problem.group, {}, border);
    const SymmetricInterior interior = eliminated_interior(analysis, problem.lower);
    for (const double factor : {1.0, -0.3, 2.5}) {
      CAPTURE(factor);
      SparseMatrix lower = problem.lower;
      for (Index j = 0; j < n; ++j)
        for (SparseMatrix::InnerIterator e(lower, j); e; ++e)
          if (on_border[at(j)] && on_border[at(e.row())]) e.valueRef() *= factor;
      const SymmetricFactor shared(interior, lower), whole(analysis, lower);
      const Vector g = RandomStream(7).normal_vector(count(border));
      Vector b = Vector::Zero(n);
      b(border) = g;
      check_factor(shared, lower, full(lower), b);
      const Vector x = shared.solve(b);
      CHECK(x == whole.solve(b));
      const SymmetricFactor plain(SymmetricAnalysis(lower, problem.group), lower);  // knows no border
      CHECK(plain.negative_eigenvalues() == shared.negative_eigenvalues());
      CHECK(largest(x - plain.solve(b)) < 1e-10 * largest(x));
      CHECK(shared.solve_from_border(g) == x);
      CHECK(shared.solve_on_border(g) == Vector(x(border)));
      const Vector anywhere = RandomStream(8).normal_vector(n);
      CHECK(shared.solve_to_border(anywhere) == Vector(shared.solve(anywhere)(border)));
    }
  }
}

TEST_CASE("symmetric factor: rows that are kept leave their Schur complement, and solves go in steps") {
  int kept_something = 0;
  for (const SymmetricProblem& problem : every_symmetric_problem()) {
    CAPTURE(problem.name);
    const Index n = problem.lower.rows(), groups = *std::ranges::max_element(problem.group) + 1;
    if (std::ranges::count(problem.group, -1) > 0) continue;
    for (const Index every : {1, 3, 5}) {  // all groups are kept, or some of them
      CAPTURE(every);
      std::vector<char> kept(at(groups), 0), last(at(groups), 0);
      for (Index g = 0; g < groups; g += every) kept[at(g)] = 1;
      for (Index g = 1; g < groups; g += 4) last[at(g)] = 1;
      std::vector<Index> border, rest;
      for (Index i = 0; i < n; ++i) (kept[at(problem.group[at(i)])] ? border : rest).push_back(i);
      const SymmetricAnalysis analysis(problem.lower, problem.group, {last, kept}, border);
      const std::vector<Index> rows = analysis.kept_rows();
      std::vector<Index> by_group = border;
      std::ranges::stable_sort(by_group, {}, [&](Index row) { return problem.group[at(row)]; });
      REQUIRE(rows == by_group);
      const Matrix a = full(problem.lower), a_ee = a(rest, rest), a_ke = a(rows, rest);
      if (!rest.empty() && symmetric_eigenvalues(a_ee).cwiseAbs().minCoeff() < 1e-3) continue;  // must be regular
      SymmetricFactor factor(analysis, problem.lower);
      if (!factor.regular()) {  // pivots are not delayed
        CHECK(problem.name == "chain of groups with empty diagonals");
        continue;
      }
      const Matrix schur = schur_complement(a(rows, rows), a_ke, a_ee);
      const Matrix found = Matrix(factor.take_kept_block()).selfadjointView<Eigen::Lower>();
      CHECK(largest(found - schur) < 1e-8 * (largest(schur) + largest(a)));
      CHECK(factor.negative_eigenvalues() == (rest.empty() ? 0 : negative_count(a_ee)));
      const Vector x = RandomStream(3).normal_vector(n), b = a * x;
      Vector half = factor.go_forward(b, Fronts::all);
      if (!rows.empty()) CHECK(largest(half(rows) - schur * x(rows)) < 1e-7 * largest(b));
      half(rows) = x(rows);
      CHECK(largest(factor.go_back(half, Fronts::all) - x) < 1e-6 * largest(x));
      ++kept_something;
    }
  }
  CHECK(kept_something > 10);
}

TEST_CASE("symmetric factor: work is counted, and parted into interior and border") {
  const Index n = 120;
  const SparseMatrix dense =
      lower_triangle(Matrix::Constant(n, n, 1) + static_cast<double>(n) * Matrix::Identity(n, n));
  double operations = 0;  // elimination as one learns it, multiplications and additions of the lower triangle
  for (Index k = 0; k < n; ++k)
    for (Index i = k + 1; i < n; ++i)
      for (Index j = k + 1; j <= i; ++j) operations += 2;
  const EliminationWork whole = SymmetricAnalysis(dense, single_rows(n)).work();
  CHECK(whole.flops(true) == doctest::Approx(operations).epsilon(2.0 / static_cast<double>(n)));
  CHECK(whole.interior_entries + whole.border_entries == static_cast<double>(n * (n + 1) / 2));
  const EliminationWork front = work_of_front(30, n - 30), rest = work_of_front(n - 30, 0);
  CHECK(front.flops(true) + rest.flops(true) == doctest::Approx(whole.flops(true)));

  const SparseMatrix sparse = shifted_laplacian(30, 31, 0);
  std::vector<Index> border(10);
  std::iota(border.begin(), border.end(), sparse.rows() - 10);
  const SymmetricAnalysis analysis(sparse, single_rows(sparse.rows()), {}, border);
  const EliminationWork work = analysis.work();
  CHECK(work.interior_flops > 0);
  CHECK(work.border_flops > 0);
  CHECK(work.interior_entries + work.border_entries == doctest::Approx(analysis.entries()));
  CHECK(work.flops(true) == work.interior_flops + work.border_flops);
  CHECK(work.flops(false) == work.border_flops);
  CHECK(work.solve_flops(Fronts::all, Fronts::all) == doctest::Approx(4 * analysis.entries()));
  CHECK(work.solve_flops(Fronts::border, Fronts::border) == doctest::Approx(4 * work.border_entries));
}

TEST_CASE("dense front: pivots, Schur complement and solves of part of a matrix") {
  for (const Index pivots : {0, 1, 7, 150, 200}) {
    CAPTURE(pivots);
    const Index n = 200, rest = n - pivots;
    const Vector noise = RandomStream(9).normal_vector(n * n);
    Matrix a = Eigen::Map<const Matrix>(noise.data(), n, n);
    a = (a + a.transpose()).eval();
    std::vector<Index> ends;
    for (Index end = std::min<Index>(3, pivots); end <= pivots && end > 0; end += 3) ends.push_back(end);
    if (pivots > 0 && ends.back() != pivots) ends.push_back(pivots);
    DenseFront front(a.triangularView<Eigen::Lower>(), ends);
    REQUIRE(front.regular());
    const Matrix head = a.topLeftCorner(pivots, pivots), side = a.bottomLeftCorner(rest, pivots);
    CHECK(front.negative_eigenvalues() == (pivots == 0 ? 0 : negative_count(head)));
    const Matrix schur = schur_complement(a.bottomRightCorner(rest, rest), side, head);
    const Matrix update = front.take_update().selfadjointView<Eigen::Lower>();
    if (rest > 0) CHECK(largest(update - schur) < 1e-8 * largest(schur));
    const Vector x = RandomStream(4).normal_vector(n);
    Vector values = a * x;
    front.go_forward(values);
    if (rest > 0) CHECK(largest(values.tail(rest) - schur * x.tail(rest)) < 1e-7 * largest(schur));
    values.tail(rest) = x.tail(rest);
    front.go_back(values);
    CHECK(largest(values - x) < 1e-7);
  }
  CHECK(!DenseFront(Matrix::Zero(4, 4), {2}).regular());
}

TEST_CASE("symmetric factor: solves from and to the border are refused without one, or with another length") {
  const SymmetricProblem problem = saddle_point(20, 0.5, 0.7, 31);
  const Index n = problem.lower.rows();
  const SymmetricFactor plain = factorise(problem);
  const Vector all = Vector::Ones(n), none, two = Vector::Ones(2);
  CHECK_THROWS_WITH_AS(plain.solve_to_border(all), doctest::Contains("an analysis with border rows"), Error);
  const SymmetricFactor bordered(SymmetricAnalysis(problem.lower, problem.group, {}, {n - 1, 0, 3}), problem.lower);
  for (const auto& [factor, words] :
       {std::pair(&plain, "an analysis with border rows"), {&bordered, "each of 3 border rows"}})
    for (const Vector& g : {none, two, all}) {
      CHECK_THROWS_WITH_AS(factor->solve_from_border(g), doctest::Contains(words), Error);
      CHECK_THROWS_WITH_AS(factor->solve_on_border(g), doctest::Contains(words), Error);
    }
  CHECK(bordered.solve_to_border(all).size() == 3);
}

TEST_CASE("symmetric factor: masses and stiffnesses many decades apart") {
  // D A D has the inertia of A, whatever the diagonal D.
  const SymmetricProblem plain = saddle_point(50, 0.5, 0.7, 31);
  RandomStream random(5);
  Vector scale(plain.lower.rows());
  for (double& s : scale) s = std::pow(10.0, 8 * random.uniform() - 4);
  const SparseMatrix lower = scale.asDiagonal() * plain.lower * scale.asDiagonal();
  const SymmetricFactor factor(SymmetricAnalysis(lower, plain.group), lower);
  check_factor(factor, lower, full(plain.lower), scale.cwiseProduct(Vector::Ones(scale.size())), 1e-8);
}

TEST_CASE("symmetric factor: a singular matrix is reported, or shows in what it solves; no number is reported, too") {
  SymmetricProblem broken = saddle_point(20, 0.5, 0.7, 51);
  broken.lower.coeffRef(3, 3) = not_a_number;
  CHECK_FALSE(factorise(broken).regular());
  Matrix row_of_zeros = Vector::LinSpaced(9, 1, 2).asDiagonal();
  row_of_zeros(4, 4) = 0;
  CHECK_FALSE(factorise({"", lower_triangle(row_of_zeros), single_rows(9)}).regular());
  CHECK_FALSE(factorise({"", lower_triangle(Matrix::Zero(1, 1)), {0}}).regular());
  // A free Laplacian: constants are its kernel.
  for (const Index n : {6, 50, 300}) {
    CAPTURE(n);
    Matrix free = Matrix::Zero(n, n);
    for (Index i = 0; i + 1 < n; ++i) {
      free(i, i) += 1;
      free(i + 1, i + 1) += 1;
      free(i + 1, i) = -1;
    }
    const SparseMatrix lower = lower_triangle(free);
    const SymmetricFactor factor(SymmetricAnalysis(lower, single_rows(n)), lower);
    const Vector b = Vector::LinSpaced(n, 0, 1);  // not in the range
    CHECK(singular_shows(factor, lower, b));
  }
  // Two multipliers for one tie.
  SymmetricProblem twice = saddle_point(20, 1.0, 0.0, 41);
  const Index n = twice.lower.rows();
  Matrix more = Matrix::Zero(n + 1, n + 1);
  more.topLeftCorner(n, n) = full(twice.lower);
  more.row(n).head(n) = more.row(n - 1).head(n);
  more.col(n).head(n) = more.col(n - 1).head(n);
  twice.lower = lower_triangle(more);
  twice.group.push_back(twice.group.back());
  const SymmetricFactor factor = factorise(twice);
  Vector b = Vector::Zero(n + 1);
  b[n] = 1;  // multipliers n - 1 and n ask for different gaps
  CHECK(singular_shows(factor, twice.lower, b));
}

TEST_CASE("backward error: its definition, entry by entry") {
  const Matrix a = full(saddle_point(10, 0.5, 0.7, 61).lower);
  const SparseMatrix lower = lower_triangle(a);
  const Vector b = RandomStream(1).normal_vector(a.rows()), x = RandomStream(2).normal_vector(a.rows());
  double expected = 0;
  for (Index i = 0; i < a.rows(); ++i) {
    double residual = b[i], size = std::abs(b[i]);
    for (Index j = 0; j < a.cols(); ++j) {
      residual -= a(i, j) * x[j];
      size += std::abs(a(i, j) * x[j]);
    }
    expected = std::max(expected, std::abs(residual) / size);
  }
  CHECK(backward_error(lower, x, b) == doctest::Approx(expected).epsilon(1e-12));
  // Data changed by a relative 1e-5 in one entry show as at most that; nothing shows as nothing.
  const Vector exact = solve(a, b);
  Vector changed = b;
  changed[4] *= 1 + 1e-5;
  CHECK(backward_error(lower, exact, b) < 1e-13);
  CHECK(backward_error(lower, exact, changed) <= 1e-5);
  CHECK(backward_error(lower, exact, changed) > 1e-8);
  CHECK(backward_error(lower, Vector::Zero(a.rows()), Vector::Zero(a.rows())) == 0);
  CHECK(backward_error(lower, Vector::Zero(a.rows()), b) == 1);
}
