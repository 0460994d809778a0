// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/dense.hpp"
#include "../support/matrices.hpp"
#include "../support/sanitized.hpp"
#include "linalg/krylov.hpp"
#include "linalg/least_squares.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "linalg/range_projector.hpp"
#include "linalg/scalar.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("sparse matrix: it moves, and an empty one in its place frees its memory") {
  static_assert(std::is_nothrow_move_constructible_v<SparseMatrix> && std::is_nothrow_move_assignable_v<SparseMatrix>);
  SparseEntries entries;
  for (Index i = 0; i < 50; ++i) entries.add(i, i / 2, static_cast<double>(i) + 1);
  SparseMatrix first = entries.matrix(50, 25);
  const double* const values = first.valuePtr();
  const Matrix dense = first;
  SparseMatrix second = std::move(first);
  CHECK(second.valuePtr() == values);
  CHECK(Matrix(second) == dense);
  SparseMatrix third(3, 4);
  third = std::move(second);
  CHECK(third.valuePtr() == values);
  CHECK(Matrix(third) == dense);
  SparseMatrix copy = third;
  CHECK(copy.valuePtr() != values);
  CHECK(Matrix(copy) == dense);
  third = {};
  CHECK(third.rows() == 0);
  CHECK(third.data().allocatedSize() == 0);
}

TEST_CASE("pencil: known ends, sizes small and large, with a residual that bounds") {
  for (const Index n : {1, 2, 3, 24, 25, 60, 150}) {
    CAPTURE(n);
    Vector expected(n);
    for (Index i = 0; i < n; ++i) expected[i] = -0.5 + 1.7 * std::sqrt(static_cast<double>(i) / static_cast<double>(n));
    const KnownPencil pencil(expected, 3);
    const PencilEnds ends = pencil_ends(pencil.a, pencil.p);
    REQUIRE(ends.failure.empty());
    CHECK(std::abs(ends.low[0] - expected[0]) < 1e-12);
    CHECK(std::abs(ends.high[0] - expected[n - 1]) < 1e-12);
    CHECK(ends.residual < 1e-12);
    CHECK(ends.residual >= 0);
    CHECK(pencil_ends(pencil.a, pencil.p).residual == ends.residual);
  }
}

TEST_CASE("pencil: the residual tells an error seen through P^-1, and is d where a value is off by d, whatever P") {
  // A nearly singular P makes eigenvalues uncertain; the residual must grow with that uncertainty.
  const Dense random = random_matrix(6, 6, 1);
  const Matrix a = random + random.transpose();
  Matrix p = identity(6);
  const double well = pencil_ends(a, p).residual;
  p(0, 0) = 1e-12;
  const PencilEnds ill = pencil_ends(a, p);
  REQUIRE(ill.failure.empty());
  CHECK(ill.residual > 1e3 * well);

  const KnownPencil pencil(Vector::LinSpaced(20, -1, 2), 9);
  const PencilEnds ends = pencil_ends(pencil.a, pencil.p, 3);
  const Matrix lower = cholesky_factor(pencil.p);
  for (const double d : {1e-3, -0.1, 5.0}) {
    const Vector values = ends.low.array() + d;
    const double residual = pair_residual(pencil.a, pencil.p, lower, values, ends.low_vectors);
    CHECK(residual == doctest::Approx(std::abs(d)).epsilon(1e-9));
  }
}

TEST_CASE("pencil: multiple eigenvalues, the zero matrix, an indefinite P, numbers that are none") {
  for (const Index n : {5, 40}) {
    Vector expected = Vector::Constant(n, 0.25);
    expected.tail(2).setConstant(0.75);
    const KnownPencil pencil(expected, 8);
    const PencilEnds ends = pencil_ends(pencil.a, pencil.p);
    CHECK(std::abs(ends.low[0] - 0.25) < 1e-12);
    CHECK(std::abs(ends.high[0] - 0.75) < 1e-12);
    CHECK(ends.residual < 1e-11);
    const PencilEnds zero = pencil_ends(Matrix::Zero(n, n), pencil.p);
    CHECK((zero.low[0] == 0 && zero.high[0] == 0));
    CHECK(zero.residual == 0);
    CHECK(pencil_ends(pencil.a, -pencil.p).failure == "P is not positive definite in double precision");
    Matrix broken = pencil.a;
    broken(1, 1) = not_a_number;
    CHECK(pencil_ends(broken, pencil.p).failure == "an entry is not finite");
  }
}

TEST_CASE("kernel split: dimensions, null space, complement") {
  const Dense b = random_matrix(12, 7, 2);
  const Dense s = b * b.transpose();
  const KernelSplit split = split_kernel(s, 5);
  CHECK(split.kernel.cols() == 5);
  CHECK(split.range.cols() == 7);
  CHECK((Dense(split.kernel).transpose() * split.range).norm() < 1e-12);
  CHECK((s * split.kernel).norm() < 1e-11);
  CHECK(split_kernel(Matrix::Identity(3, 3), 0).kernel.cols() == 0);
  CHECK(split_kernel(Matrix::Zero(3, 3), 3).range.cols() == 0);
}

TEST_CASE("Lanczos: both ends of a known pencil, same bits twice, too small refused; the identity (B = 0)") {
  Vector expected = Vector::LinSpaced(80, 0.05, 1.95);
  const KnownPencil pencil(expected, 21);
  const LinearMap solve = solver(pencil.p);
  for (const auto& [end, value] : {std::pair{SpectrumEnd::smallest, 0.05}, {SpectrumEnd::largest, 1.95}}) {
    const LanczosResult result = lanczos(80, map_of(pencil.a), map_of(pencil.p), solve, end);
    CHECK(result.converged);
    CHECK(result.value == doctest::Approx(value).epsilon(1e-11));
    CHECK((pencil.a * result.vector - result.value * pencil.p * result.vector).norm() < 1e-7 * result.vector.norm());
    const LanczosResult again = lanczos(80, map_of(pencil.a), map_of(pencil.p), solve, end);
    CHECK((again.value == result.value && again.vector == result.vector));
  }
  CHECK_THROWS_AS(lanczos(4, map_of(pencil.a), map_of(pencil.p), solve, SpectrumEnd::largest), Error);
  for (const Index n : {arpack_smallest_size, Index{30}}) {
    const LinearMap identity = [](const Vector& x) -> Vector { return x; };
    const LanczosResult result = lanczos(n, identity, identity, identity, SpectrumEnd::largest);
    CHECK(result.converged);
    CHECK(result.value == doctest::Approx(1.0).epsilon(1e-12));
  }
}

TEST_CASE("Arnoldi: real, negative and complex dominant eigenvalues, with their residual") {
  const Dense q = random_orthogonal(50, 4);
  Matrix t = Matrix::Zero(50, 50);
  for (Index i = 0; i < 50; ++i) {
    t(i, i) = 0.5 * std::cos(static_cast<double>(i));
    for (Index j = i + 1; j < 50; ++j) t(i, j) = 0.02;
  }
  for (const std::complex<double> value : {std::complex<double>(0.9, 0), {-0.95, 0}, {0.4, 0.8}, {-0.3, 0.9}}) {
    Matrix block = t;
    block(0, 0) = block(1, 1) = value.real();
    if (value.imag() == 0) {
      block(1, 1) = 0.1;
    } else {
      block(0, 1) = value.imag();
      block(1, 0) = -value.imag();
    }
    const ArnoldiResult result = arnoldi(50, map_of(q * block * q.transpose()));
    CHECK(result.converged);
    CHECK(result.value.real() == doctest::Approx(value.real()).epsilon(1e-9));
    CHECK(result.value.imag() == doctest::Approx(value.imag()).epsilon(1e-9));
    CHECK(result.residual < 1e-8);
  }
}

TEST_CASE("Arnoldi: a run that is cut off has not converged, whatever it has found by then") {
  Matrix crowded = Matrix::Zero(200, 200);
  for (Index i = 0; i < 200; ++i)
    crowded(i, i) = i < 2 ? 2.0 - 0.5 * static_cast<double>(i) : 1 - 1e-4 * static_cast<double>(i);
  int cut = 0;
  for (const int restarts : {1, 2, 3, 4, 6, 8}) {
    const ArnoldiResult result = arnoldi(200, map_of(crowded), {.maximum_restarts = restarts});
    if (std::isfinite(result.residual) && !result.converged) ++cut;
  }
  CHECK(cut > 0);
  CHECK(arnoldi(200, map_of(crowded)).converged);
}

TEST_CASE("sparse Cholesky: solves, reuses a pattern, tells a matrix that is not definite") {
  const Dense b = random_matrix(20, 20, 6);
  const Dense dense = b * b.transpose() + identity(20);
  const SparseMatrix a = dense.entries().sparseView();
  const CholeskyAnalysis analysis(a);
  const Dense right = random_matrix(20, 3, 9);
  const SparseCholesky cholesky(analysis, a);
  REQUIRE(cholesky.positive_definite());
  CHECK((dense * cholesky.solve(right) - right).norm() < 1e-11 * right.norm());
  const SparseMatrix twice = 2 * a;
  CHECK((dense * SparseCholesky(analysis, twice).solve(right) - 0.5 * right).norm() < 1e-11 * right.norm());
  CHECK_FALSE(SparseCholesky(analysis, SparseMatrix(-a)).positive_definite());
}

TEST_CASE("left singular vectors: tall, wide, square and without columns, small values to their last digits") {
  for (const auto& shape : {std::array<Index, 2>{9, 4}, {4, 9}, {6, 6}, {3, 0}}) {
    const Index rows = shape[0], columns = shape[1];
    INFO("rows = ", rows, ", columns = ", columns);
    const Dense a = random_matrix(rows, columns, 8);
    const ValuesAndVectors found = left_singular(a);
    REQUIRE(found.values.size() == rows);
    const Matrix& u = found.vectors;
    CHECK((u.transpose() * u - Matrix::Identity(rows, rows)).norm() < 1e-13);
    CHECK((a * a.transpose() * u - Dense(u) * diagonal(found.values.cwiseAbs2())).norm() < 1e-12);
    CHECK(found.values.minCoeff() >= 0);
    CHECK(std::is_sorted(found.values.begin(), found.values.end()));
    CHECK((found.values.array() == 0).count() == std::max<Index>(rows - columns, 0));
  }
  const Matrix q = orthogonal_factor(random_matrix(5, 5, 1)), w = orthogonal_factor(random_matrix(7, 5, 2));
  const Vector values = (Vector(5) << 1e-13, 1e-9, 1e-5, 1e-2, 1).finished();
  const ValuesAndVectors small = left_singular(q * values.asDiagonal() * w.leftCols(5).transpose());
  CHECK((small.values - values).norm() < 1e-15);
  CHECK(std::abs(std::abs(small.vectors.col(1).dot(q.col(1))) - 1) < 1e-12);
}

TEST_CASE("range projector: full_rank, rank_deficient, tall, wide, zero and no columns") {
  const auto check = [](const Dense& dense, Index rank) {
    const SparseMatrix a = dense.entries().sparseView();
    const RangeProjector range(a);
    CHECK(range.rank() == rank);
    CHECK(sparse_rank(a).value == rank);
    const Vector x = RandomStream(5).normal_vector(dense.rows());
    const Vector p = range.apply(x);
    CHECK((range.apply(p) - p).norm() < 1e-12);           // a projector
    CHECK((dense.transpose() * (x - p)).norm() < 1e-10);  // orthogonal to what is left
    if (dense.cols() == 0) return;
    const Vector first = dense.entries().col(0);
    CHECK((range.apply(first) - first).norm() < 1e-11);
  };
  check(random_matrix(9, 5, 1), 5);
  check(random_matrix(5, 9, 2), 5);
  check(random_matrix(9, 3, 3) * random_matrix(3, 7, 4), 3);
  check(zero(4, 3), 0);
  check(zero(4, 0), 0);
  Matrix repeated = random_matrix(8, 6, 5);
  repeated.col(4) = repeated.col(1);
  check(repeated, 5);
}

TEST_CASE("range projector: what counts as zero without being zero tilts projector and basis by as much as is said") {
  for (const double near : {0.0, 1e-13, 1e-11, 1e-9, 1e-8, 1e-7}) {
    CAPTURE(near);
    Matrix a = random_matrix(30, 20, 5);
    a.rightCols(8) = a.leftCols(12) * Matrix(random_matrix(12, 8, 6));
    for (Index j = 12; j < 20; ++j) a.col(j) += near * a.col(j).norm() * Matrix(random_matrix(30, 1, at(j))).col(0);
    for (Index j = 0; j < 20; ++j) a.col(j).normalize();
    const SparseMatrix sparse = a.sparseView();
    const RangeProjector projector(sparse, rank_tolerance, Tilt::measured);
    const RangeBasis basis = range_basis(sparse);
    REQUIRE(projector.rank() == 12);
    REQUIRE(basis.size() == 12);
    // Of the larger singular values.
    const Dense leading = symmetric_eigen(Dense(a) * Dense(a).transpose()).vectors.rightCols(12).eval();
    const auto outside = [&](const Dense& x) { return (x - leading * (leading.transpose() * x)).norm(); };
    Matrix image(30, 30);
    for (Index k = 0; k < 30; ++k) image.col(k) = projector.apply(Matrix::Identity(30, 30).col(k));
    Matrix chosen(30, 12);
    for (Index j = 0; j < count(basis.columns); ++j) chosen.col(j) = a.col(basis.columns[at(j)]);
    chosen.rightCols(basis.others.cols()) = basis.others;
    const Matrix orthonormal = orthogonal_factor(Dense(chosen));
    for (const double tilt : {outside(image), outside(orthonormal.leftCols(12).eval())}) {
      CHECK(tilt <= 3 * basis.tilt + 1e-13);
      CHECK(basis.tilt <= 1e3 * tilt + 1e-12);
    }
    CHECK(projector.tilt() == basis.tilt);
  }
}

TEST_CASE("ranks: a column counts from the tolerance on; where factors near it disagree, eigenvalues decide") {
  const double tolerance = 1e-3;
  // Pairs of unit columns at an angle: the smaller eigenvalue of B^T B is 1 - cos(angle).
  const auto pairs = [&](Index rows, const std::vector<double>& shares) {
    Matrix near = Matrix::Zero(rows, 2 * count(shares));
    for (Index k = 0; k < count(shares); ++k) {
      const double angle = std::acos(1 - shares[at(k)] * tolerance * tolerance);
      near.block(2 * k, 2 * k, 2, 2) << 1, std::cos(angle), 0, std::sin(angle);
    }
    return SparseMatrix(near.sparseView());
  };
  CHECK(sparse_rank(pairs(3, {2.0}), tolerance).value == 2);  // not from a few times the tolerance on
  CHECK(sparse_rank(pairs(3, {0.5}), tolerance).value == 1);
  // Smaller eigenvalues that lie between the tolerances that are tried.
  const SparseMatrix a = pairs(8, {0.17, 0.55, 1.7, 5.5});
  CHECK_FALSE(RangeProjector(a, tolerance).conclusive());
  CHECK(sparse_rank(a, tolerance).value == 6);
}

TEST_CASE("ranks: one that rounding may have decided is not conclusive") {
  int doubtful = 0;
  for (std::uint64_t seed = 1; seed <= (sanitized ? 2 : 20); ++seed)
    for (const Index rank : {3, 20}) {
      INFO("seed = ", seed, ", rank = ", rank);
      const Matrix product = random_matrix(60, rank, seed) * random_matrix(rank, 40, seed + 100);
      const SparseMatrix a = product.sparseView();
      for (const double tolerance : {1e-6, 1e-7, 1e-8, 1e-9}) {
        CAPTURE(tolerance);
        const RangeProjector range(a, tolerance);
        if (range.conclusive()) CHECK(range.rank() == rank);
        if (tolerance == 1e-6) CHECK(range.conclusive());
        doubtful += !range.conclusive();
      }
    }
  CHECK((sanitized || doubtful > 0));
}

TEST_CASE("searches: a root, a minimum, and refusals") {
  const ScalarSearch root = find_root([](double x) { return x * x - 2; }, 0, 2, 1e-14);
  CHECK(root.converged);
  CHECK(root.x == doctest::Approx(std::sqrt(2.0)).epsilon(1e-13));
  CHECK_THROWS_AS(find_root([](double x) { return x * x + 1; }, 0, 2, 1e-12), Error);
  const ScalarSearch least = find_minimum([](double x) { return std::cos(x); }, 2, 3, 5, 1e-6);
  CHECK(least.converged);
  CHECK(least.x == doctest::Approx(3.14159265358979).epsilon(1e-6));
  CHECK_THROWS_AS(find_minimum([](double x) { return x; }, 0, 1, 2, 1e-6), Error);
  struct Mishap {};  // an exception of the function crosses the C library unharmed
  CHECK_THROWS_AS(find_root([](double) -> double { throw Mishap{}; }, 0, 1, 1e-8), Mishap);
}

TEST_CASE("linear fit: exact line, standard error, too few points") {
  const std::vector<double> x{0, 1, 2, 3}, y{1, 3, 5, 7};
  const LinearFit fit = linear_fit(x, y);
  CHECK(fit.slope == doctest::Approx(2));
  CHECK(fit.intercept == doctest::Approx(1));
  CHECK(fit.slope_error < 1e-12);
  CHECK(linear_fit(x, std::vector<double>{1, 3.1, 4.9, 7}).slope_error > 0.01);
  CHECK_THROWS_AS(linear_fit(std::vector<double>{1, 2}, std::vector<double>{1, 2}), Error);
}

TEST_CASE("random streams repeat by seed") {
  RandomStream a(7), b(7), c(8);
  const Vector first = a.normal_vector(10);
  CHECK(first == b.normal_vector(10));
  CHECK(first != c.normal_vector(10));
  for (int i = 0; i < 100; ++i) {
    const Index k = a.below(3);
    CHECK(k >= 0);
    CHECK(k < 3);
  }
}

TEST_CASE("least squares: the solution of least norm, dense and sparse, wide and tall, any rank, empty columns") {
  // Directions within rounding of none do not count.
  const Matrix dense = random_matrix(30, 5, 5) * random_matrix(5, 12, 6);
  const Vector right = RandomStream(3).normal_vector(30);
  const LeastSquares found = minimum_norm_least_squares(dense, right);
  CHECK(found.rank == 5);
  const Vector least = pseudo_inverse(dense, 1e-10).apply(right);
  CHECK((found.solution - least).norm() < 1e-10 * least.norm());

  RandomStream random(17);
  for (const auto& shape : {std::array<Index, 3>{60, 40, 40}, {40, 60, 40}, {60, 60, 25}, {30, 80, 11}}) {
    const Index rows = shape[0], columns = shape[1], rank = shape[2];
    INFO("rows = ", rows, ", columns = ", columns);
    Matrix product = random_matrix(rows, rank, 5) * random_matrix(rank, columns, 6);
    product.col(3).setZero();
    const SparseMatrix a = product.sparseView();
    for (const bool consistent : {true, false}) {
      const Vector b = consistent ? Vector(product * random.normal_vector(columns)) : random.normal_vector(rows);
      const Vector x = minimum_norm_least_squares(a, b);
      const Vector expected = pseudo_inverse(product, 1e-10).apply(b);
      CHECK((x - expected).norm() < 1e-9 * expected.norm());
      CHECK(x[3] == 0);
    }
    CHECK(minimum_norm_least_squares(a, Vector::Zero(rows)).norm() == 0);
  }
}

TEST_CASE("sparse least squares: differences of neighbours, whose inverse is the sum, thousands of them") {
  // The condition of A^T A grows with n^2: conjugate gradients without a good inverse need n iterations.
  const Index n = 4000;
  SparseEntries entries;
  for (Index i = 0; i < n; ++i) {
    entries.add(i, i, 1);
    if (i > 0) entries.add(i, i - 1, -1);
  }
  const Vector b = RandomStream(11).normal_vector(n);
  Vector sums = b;
  for (Index i = 1; i < n; ++i) sums[i] += sums[i - 1];
  CHECK((minimum_norm_least_squares(entries.matrix(n, n), b) - sums).norm() < 1e-8 * sums.norm());
}
