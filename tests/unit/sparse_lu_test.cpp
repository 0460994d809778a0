// SPDX-License-Identifier: GPL-3.0-or-later
// Our own sparse L U against dense algebra: solves, signs of determinants, many matrices of one pattern.
#include "../support/matrices.hpp"
#include "linalg/multifrontal/lu.hpp"
#include "linalg/random.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Bodies with three rows each on a grid, tied to their neighbours by blocks that are not symmetric. Some of the heavy
// entries on the diagonal are negative.
SparseMatrix grid_of_bodies(Index width, Index height, RandomStream& random) {
  SparseEntries entries;
  const auto tie = [&](Index a, Index b, double heavy) {
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < 3; ++j)
        entries.add(3 * a + i, 3 * b + j, random.normal() + (i != j ? 0 : random.uniform() < 0.3 ? -heavy : heavy));
  };
  for (Index y = 0; y < height; ++y)
    for (Index x = 0; x < width; ++x) {
      const Index here = y * width + x;
      tie(here, here, 5);
      for (const Index other : {x + 1 < width ? here + 1 : -1, y + 1 < height ? here + width : -1}) {
        if (other < 0) continue;
        tie(here, other, 0);
        tie(other, here, 0);
      }
    }
  return entries.matrix(3 * width * height, 3 * width * height);
}

double error(const SparseMatrix& a, const Vector& x, const Vector& b) { return (a * x - b).norm() / b.norm(); }

}  // namespace

TEST_CASE("sparse LU: solves and signs of determinants are those of the dense matrix") {
  RandomStream random(4);
  Index negative = 0;
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 1}, {5, 4}, {9, 8}}) {
    SparseMatrix a = grid_of_bodies(width, height, random);
    SparseLu lu(a);
    for (int k = 0; k < 8; ++k) {  // one pattern, other values
      INFO("rows = ", a.rows(), ", k = ", k);
      REQUIRE(lu.factorise(a));
      const bool below_zero = determinant(a) < 0;
      CHECK(lu.determinant_sign() == (below_zero ? -1 : 1));
      negative += below_zero;
      const Vector b = random.normal_vector(a.rows());
      CHECK(error(a, lu.solve(b), b) < 1e-10);
      a = grid_of_bodies(width, height, random);
    }
  }
  CHECK(negative > 5);  // both signs were met
  CHECK(negative < 35);
}

TEST_CASE("sparse LU: a pattern that is not symmetric") {
  RandomStream random(5);
  SparseEntries entries;
  constexpr Index n = 40;
  for (Index i = 0; i < n; ++i) {
    entries.add(i, (i + 1) % n, 1 + random.uniform());
    entries.add(i, i, i % 3 == 0 ? -4 : 4);
    if (i % 4 == 0) entries.add(i, (i + 7) % n, random.normal());
  }
  const SparseMatrix a = entries.matrix(n, n);
  SparseLu lu(a);
  REQUIRE(lu.factorise(a));
  const Vector b = random.normal_vector(n);
  CHECK(error(a, lu.solve(b), b) < 1e-10);
  CHECK(lu.determinant_sign() == (determinant(a) < 0 ? -1 : 1));
}

TEST_CASE("sparse LU: rows are exchanged where a pivot is zero, and a singular matrix is reported") {
  SparseEntries entries;  // two bodies of two rows; the first pivot of each is zero
  for (const Index first : {0, 2}) {
    entries.add(first, first, 0);
    entries.add(first, first + 1, 2);
    entries.add(first + 1, first, 3);
    entries.add(first + 1, first + 1, 1);
  }
  SparseMatrix a = entries.matrix(4, 4);
  SparseLu lu(a);
  REQUIRE(lu.factorise(a));
  const Vector b = Vector::LinSpaced(4, 1, 4);
  CHECK(error(a, lu.solve(b), b) < 1e-14);
  CHECK(lu.determinant_sign() == 1);  // (-6)^2
  a.coeffRef(0, 1) = 0;
  CHECK_FALSE(lu.factorise(a));
  a.coeffRef(0, 1) = std::nan("");
  CHECK_FALSE(lu.factorise(a));
  a.coeffRef(0, 1) = 2;  // and what it saw before does not matter
  REQUIRE(lu.factorise(a));
  CHECK(error(a, lu.solve(b), b) < 1e-14);
}

TEST_CASE("sparse LU: the bits do not depend on the number of threads") {
  RandomStream random(6);
  const SparseMatrix a = grid_of_bodies(60, 50, random);  // enough work for tasks
  const Vector b = random.normal_vector(a.rows());
  std::vector<Vector> solutions;
  for (const Index threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    SparseLu lu(a);
    REQUIRE(lu.factorise(a));
    solutions.push_back(lu.solve(b));
  }
  CHECK(error(a, solutions[0], b) < 1e-9);
  CHECK(solutions[1] == solutions[0]);
  CHECK(solutions[2] == solutions[0]);
}

TEST_CASE("sparse LU: the factors of a full matrix take 2 n^3 / 3 operations") {
  constexpr Index n = 60;
  RandomStream random(2);
  const Dense a = random_matrix(n, n, random) + 20.0 * identity(n);
  const SparseMatrix matrix = Matrix(a).sparseView();
  SparseLu lu(matrix);
  CHECK(lu.operations() == 0);
  REQUIRE(lu.factorise(matrix));
  const double once = lu.operations();
  CHECK(once == doctest::Approx(2.0 / 3 * n * n * n).epsilon(0.05));
  REQUIRE(lu.factorise(matrix));
  CHECK(lu.operations() == doctest::Approx(2 * once));
  lu.solve(random.normal_vector(n));
  CHECK(lu.operations() == doctest::Approx(2 * once + 2.0 * n * n));  // both triangles at least once
}

TEST_CASE("sparse LU: no rows, rows that nothing ties, and a front that is singular for once") {
  SparseLu none(SparseMatrix(0, 0));
  CHECK(none.factorise(SparseMatrix(0, 0)));
  CHECK(none.solve(Vector()).size() == 0);
  CHECK(none.determinant_sign() == 1);
  RandomStream random(7);
  SparseEntries entries;
  entries.add_block(grid_of_bodies(6, 5, random), 0, 0);
  entries.add_block(grid_of_bodies(4, 4, random), 91, 91);
  entries.add(90, 90, -2);  // alone
  const SparseMatrix good = entries.matrix(139, 139);
  SparseLu lu(good);
  const Vector b = random.normal_vector(139);
  for (const double spoilt : {0.0, infinity, std::nan("")}) {
    CAPTURE(spoilt);
    SparseMatrix bad = good;
    bad.coeffRef(90, 90) = spoilt;
    CHECK_FALSE(lu.factorise(bad));
    REQUIRE(lu.factorise(good));
    CHECK(error(good, lu.solve(b), b) < 1e-10);
  }
  CHECK_THROWS_AS(lu.factorise(SparseMatrix(139, 139)), Error);
}
