// SPDX-License-Identifier: GPL-3.0-or-later
// Shift-inverted Lanczos on pencils whose eigenvalues are known.
#include "../support/matrices.hpp"
#include "linalg/krylov.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Vector spread(Index n) {  // in (0.2, 1.4], crowding at the low end
  Vector values(n);
  for (Index i = 0; i < n; ++i)
    values[i] = 0.2 + 1.2 * std::pow((static_cast<double>(i) + 1) / static_cast<double>(n), 1.5);
  return values;
}

struct Run {
  const KnownPencil& pencil;
  ShiftInvertResult operator()(double sigma, SpectrumEnd end, Index wanted, const Vector& start = {},
                               const ShiftInvertOptions& options = {}) const {
    return shift_invert_lanczos({pencil.p.rows(), shifted_inverse(pencil, sigma), map_of(pencil.p), sigma}, end, wanted,
                                options, start);
  }
};

// `values` in the order in which they come from that end.
Vector nearest(const Vector& ascending, double sigma, SpectrumEnd end, Index wanted) {
  std::vector<double> list;
  for (const double value : ascending)
    if (end == SpectrumEnd::smallest ? value > sigma : value < sigma) list.push_back(value);
  if (end == SpectrumEnd::largest) std::reverse(list.begin(), list.end());
  return Eigen::Map<Vector>(list.data(), std::min(wanted, count(list)));
}

}  // namespace

TEST_CASE("shift-invert Lanczos: both ends of known pencils, one eigenvalue and several") {
  for (const Index n : {5, 6, 30, 120}) {
    const Vector values = spread(n);
    const KnownPencil pencil(values, 3);
    const Run run{pencil};
    for (const SpectrumEnd end : {SpectrumEnd::smallest, SpectrumEnd::largest})
      for (const double distance : {1e-3, 0.1, 1.0})
        for (const Index wanted : {1, 2, 3, 8}) {
          if (wanted > n - 2) continue;
          const double sigma = end == SpectrumEnd::smallest ? values[0] - distance : values[n - 1] + distance;
          INFO("n = ", n, ", sigma = ", sigma, ", wanted = ", wanted);
          const ShiftInvertResult found = run(sigma, end, wanted);
          REQUIRE(found.converged);
          REQUIRE(found.values.size() == wanted);
          REQUIRE(found.vectors.cols() == wanted);
          CHECK(found.applications > 0);
          CHECK((found.values - nearest(values, sigma, end, wanted)).cwiseAbs().maxCoeff() < 1e-9);
          for (Index k = 0; k < wanted; ++k) {
            const Vector x = found.vectors.col(k);
            CHECK((pencil.a * x - found.values[k] * (pencil.p * x)).norm() < 1e-7 * (pencil.p * x).norm());
          }
        }
  }
}

TEST_CASE("shift-invert Lanczos: from inside the spectrum, one side only") {
  const Vector values = spread(60);
  const KnownPencil pencil(values, 8);
  for (const Index k : {10, 30, 50}) {
    const double sigma = 0.4 * values[k] + 0.6 * values[k + 1];
    for (const SpectrumEnd end : {SpectrumEnd::smallest, SpectrumEnd::largest}) {
      const ShiftInvertResult found = Run{pencil}(sigma, end, 3);
      REQUIRE(found.converged);
      CHECK((found.values - nearest(values, sigma, end, 3)).cwiseAbs().maxCoeff() < 1e-9);
    }
  }
}

TEST_CASE("shift-invert Lanczos: clusters and multiple eigenvalues at the end") {
  for (const double width : {0.0, 1e-10, 1e-5}) {
    CAPTURE(width);
    Vector values = spread(80);
    for (Index i = 0; i < 4; ++i) values[i] = values[0] + width * static_cast<double>(i);
    const KnownPencil pencil(values, 13);
    for (const double distance : {1e-4, 1e-2, 1.0}) {
      const ShiftInvertResult found = Run{pencil}(values[0] - distance, SpectrumEnd::smallest, 6);
      REQUIRE(found.values.size() > 0);
      CHECK(std::abs(found.values[0] - values[0]) < 1e-9);
      // whatever else is given is an eigenvalue, too
      for (const double value : found.values) CHECK((values.array() - value).abs().minCoeff() < 1e-9);
    }
  }
}

TEST_CASE("shift-invert Lanczos: the start vector changes values within the tolerance only") {
  const Vector values = spread(90);
  const KnownPencil pencil(values, 21);
  const Run run{pencil};
  const double sigma = values[0] - 0.02;
  const ShiftInvertResult plain = run(sigma, SpectrumEnd::smallest, 3);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const ShiftInvertResult other = run(sigma, SpectrumEnd::smallest, 3, RandomStream(seed).normal_vector(90));
    REQUIRE(other.converged);
    CHECK((other.values - plain.values).cwiseAbs().maxCoeff() < 1e-10);
  }
  // An eigenvector, right or wrong, must not trap the iteration; nor must a vector of zeros or another size.
  for (const Index k : {0, 1, 2})
    for (const Vector& start : {Vector(plain.vectors.col(k)), Vector(1e8 * plain.vectors.col(k))}) {
      const ShiftInvertResult other = run(sigma, SpectrumEnd::smallest, 3, start);
      REQUIRE(other.converged);
      CHECK((other.values - plain.values).cwiseAbs().maxCoeff() < 1e-10);
    }
  CHECK(run(sigma, SpectrumEnd::smallest, 3, Vector::Zero(90)).values == plain.values);
  CHECK(run(sigma, SpectrumEnd::smallest, 3, Vector::Ones(7)).values == plain.values);
}

TEST_CASE("shift-invert Lanczos: a good start vector saves work") {
  const KnownPencil pencil(spread(200), 34), near(1.001 * spread(200), 34);
  const ShiftInvertOptions loose{.tolerance = 1e-4};
  const Vector vector = Run{pencil}(0.19, SpectrumEnd::smallest, 1).vectors.col(0);
  const Index cold = Run{near}(0.19, SpectrumEnd::smallest, 1, {}, loose).applications;
  CHECK(Run{near}(0.19, SpectrumEnd::smallest, 1, vector, loose).applications < cold);
}

TEST_CASE("shift-invert Lanczos: equal calls give equal bits, whatever ran in between") {
  const KnownPencil pencil(spread(90), 55), other(spread(40), 56);
  const Vector start = RandomStream(4).normal_vector(90);
  const ShiftInvertResult first = Run{pencil}(0.1, SpectrumEnd::smallest, 4, start);
  Run{other}(2.0, SpectrumEnd::largest, 2);
  lanczos(40, map_of(other.a), map_of(other.p), map_of(other.p.inverse()), SpectrumEnd::largest);
  const ShiftInvertResult second = Run{pencil}(0.1, SpectrumEnd::smallest, 4, start);
  CHECK((first.values == second.values && first.vectors == second.vectors));
  CHECK(first.applications == second.applications);
}

TEST_CASE("shift-invert Lanczos: what is locked is not found again") {
  const Index n = 50;
  Vector values(n);
  for (Index i = 0; i < n; ++i) values[i] = 1 + static_cast<double>(i);
  const LinearMap inverse = [=](const Vector& x) -> Vector { return x.cwiseQuotient((values.array() - 0.5).matrix()); };
  const LinearMap mass = [](const Vector& x) { return x; };
  const Matrix locked = Matrix::Identity(n, 2);
  const ShiftInvertResult found =
      shift_invert_lanczos({n, inverse, mass, 0.5}, SpectrumEnd::smallest, 2, {}, {}, locked);
  REQUIRE(found.values.size() == 2);
  CHECK(found.values[0] == doctest::Approx(3));
  CHECK(found.values[1] == doctest::Approx(4));
  CHECK((locked.transpose() * found.vectors).norm() < 1e-10);
}

TEST_CASE("shift-invert Lanczos: too small a problem is refused, too few steps are said") {
  const KnownPencil small(spread(4), 1);
  CHECK_THROWS_AS(Run{small}(0.1, SpectrumEnd::smallest, 1), Error);
  const KnownPencil pencil(spread(150), 89);
  const ShiftInvertResult found = Run{pencil}(-50, SpectrumEnd::smallest, 2, {}, {.maximum_steps = 7});
  CHECK_FALSE(found.converged);
  CHECK(found.applications == 7);
  REQUIRE(found.values.size() == 2);
  for (Index k = 0; k < 2; ++k)  // what there is stays within its bound of an eigenvalue
    CHECK((spread(150).array() - found.values[k]).abs().minCoeff() <= found.bounds[k]);
}

TEST_CASE("shift-invert Lanczos: bounds hold where they are nearly sharp") {
  // Two steps on two pairs of neighbours, fifty copies of each: either Ritz value lies between those of a pair, as far
  // from the eigenvalues as its residual says.
  const double inverses[] = {0.9, 1.1, 2.9, 3.1};
  const Index n = 200;
  Vector nu(n);
  for (Index i = 0; i < n; ++i) nu[i] = inverses[i % 4];
  const LinearMap inverse = [&](const Vector& x) -> Vector { return nu.cwiseProduct(x); };
  const LinearMap mass = [](const Vector& x) { return x; };
  const ShiftInvertResult found =
      shift_invert_lanczos({n, inverse, mass, 0}, SpectrumEnd::smallest, 1, {.maximum_steps = 2});
  CHECK(found.applications == 2);
  REQUIRE(found.values.size() == 1);
  const double distance = (nu.cwiseInverse().array() - found.values[0]).abs().minCoeff();
  CHECK(distance <= found.bounds[0]);
  CHECK(distance > 0.3 * found.bounds[0]);
}

TEST_CASE("pencil ends: several eigenvalues against Eigen's generalised solver") {
  for (const Index n : {1, 2, 5, 30, 90}) {
    const Dense random = random_matrix(n, n, 6);
    const Dense a = random + random.transpose();
    const Dense p = KnownPencil(Vector::Ones(n), 7).p;
    const Vector exact = pencil_eigenvalues(a, p);
    for (const Index wanted : {1, 2, 5, 40, 200}) {
      INFO("n = ", n, ", wanted = ", wanted);
      const PencilEnds ends = pencil_ends(a, p, wanted);
      const Index k = std::min(n, wanted);
      REQUIRE(ends.failure.empty());
      REQUIRE(ends.low.size() == k);
      REQUIRE(ends.high.size() == k);
      CHECK((ends.low - exact.head(k)).norm() < 1e-11);
      CHECK((ends.high - exact.reverse().head(k)).norm() < 1e-11);
      REQUIRE(ends.low_vectors.rows() == n);
      const Dense low = ends.low_vectors, high = ends.high_vectors;
      CHECK((low.transpose() * p * low - identity(k)).norm() < 1e-10);
      CHECK((high.transpose() * p * high - identity(k)).norm() < 1e-10);
      CHECK((a * low - p * low * diagonal(ends.low)).norm() < 1e-9);
      CHECK((a * high - p * high * diagonal(ends.high)).norm() < 1e-9);
      CHECK(ends.residual < 1e-10);
    }
  }
}

TEST_CASE("pencil ends: multiple eigenvalues come with their multiplicity and orthonormal vectors") {
  Vector values = Vector::LinSpaced(40, -1, 1);
  values.head(6).setConstant(-1);
  values.tail(3).setConstant(1);
  const KnownPencil pencil(values, 17);
  const PencilEnds ends = pencil_ends(pencil.a, pencil.p, 7);
  CHECK((ends.low.head(6).array() + 1).abs().maxCoeff() < 1e-12);
  CHECK(ends.low[6] > -0.9);
  CHECK((ends.high.head(3).array() - 1).abs().maxCoeff() < 1e-12);
  CHECK(ends.high[3] < 0.99);
  const Dense low = ends.low_vectors;
  CHECK((low.transpose() * pencil.p * low - identity(7)).norm() < 1e-10);
}
