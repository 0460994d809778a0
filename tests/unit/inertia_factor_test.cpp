// SPDX-License-Identifier: GPL-3.0-or-later
// Our factorisation and MUMPS behind one interface: both count and solve as dense algebra does.
#include "../support/matrices.hpp"
#include "../support/mumps.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Index negative_count(const SparseMatrix& lower) { return (symmetric_eigenvalues(full(lower)).array() < 0).count(); }

InertiaPattern pattern_of(const SymmetricProblem& problem, Index border) {
  return {problem.lower, problem.group, border};
}

double largest_entry(const Vector& x) { return x.cwiseAbs().maxCoeff(); }

// Multipliers with next to nothing on their diagonal, each in a group of its own and tied to three rows: eliminated
// before these they leave pivots of that size, which are not delayed.
SymmetricProblem badly_grouped(Index pairs, double diagonal) {
  Matrix a = Matrix::Zero(2 * pairs, 2 * pairs);
  const auto tie = [&](Index multiplier, Index pair, double value) {
    a(2 * multiplier, 2 * pair + 1) = a(2 * pair + 1, 2 * multiplier) = value;
  };
  for (Index k = 0; k < pairs; ++k) {
    a(2 * k, 2 * k) = diagonal;
    a(2 * k + 1, 2 * k + 1) = 2;
    tie(k, k, 1);
    if (k > 0) tie(k, k - 1, -0.5);
    tie(k, (7 * k + 3) % pairs, 0.3);
  }
  return {"badly grouped", lower_triangle(a), single_rows(2 * pairs)};
}

// Factors of our own that all look singular.
InertiaMethod broken() {
  return {
      "broken", [](const InertiaPattern&) {
        return InertiaFamily{[](const SparseMatrix&, const std::array<double, 2>&) { return InertiaFactor{}; }, [] {}};
      }};
}

InertiaFactor factorise(const InertiaMethod& method, const SymmetricProblem& problem, Index border) {
  return method.analyse(pattern_of(problem, border)).factorise(problem.lower, {});
}

}  // namespace

TEST_CASE("inertia factor: ours and MUMPS count and solve alike on every shape of matrix") {
  for (const SymmetricProblem& problem : every_symmetric_problem()) {
    const Index n = problem.lower.rows(), border = std::max<Index>(1, n / 3);
    for (const InertiaMethod& method : {multifrontal(), mumps()}) {
      INFO("name = ", problem.name, ", method = ", method.name);
      const InertiaFactor factor = factorise(method, problem, border);
      REQUIRE(factor.regular);
      CHECK(factor.negative_eigenvalues == negative_count(problem.lower));
      CHECK(inexactness(factor, problem.lower, border) < 1e-11);
      const Vector b = RandomStream(1).normal_vector(n), g = RandomStream(2).normal_vector(border);
      Vector spread = Vector::Zero(n);
      spread.tail(border) = g;
      const Vector x = factor.solve(b), y = factor.solve(spread);
      CHECK(backward_error(problem.lower, x, b) < 1e-11);
      CHECK(backward_error(problem.lower, y, spread) < 1e-11);
      CHECK(largest_entry(factor.solve_from_border(g) - y) <= 1e-12 * largest_entry(y));
      CHECK(largest_entry(factor.solve_on_border(g) - y.tail(border)) <= 1e-12 * largest_entry(y));
      CHECK(largest_entry(factor.solve_to_border(b) - x.tail(border)) <= 1e-12 * largest_entry(x));
    }
  }
}

TEST_CASE("inertia factor: the interior is kept for equal parameters only") {
  const SymmetricProblem problem{"diagonal", lower_triangle(Matrix::Identity(10, 10)), single_rows(10)};
  const Index border = 2;
  SparseMatrix other = problem.lower;
  other.coeffRef(0, 0) = -7;  // in the interior
  const InertiaFamily family = multifrontal().analyse(pattern_of(problem, border));
  const auto count_at = [&](const SparseMatrix& lower, double parameter) {
    return family.factorise(lower, {parameter, 0}).negative_eigenvalues;
  };
  REQUIRE(negative_count(other) != negative_count(problem.lower));
  CHECK(count_at(problem.lower, 1) == negative_count(problem.lower));
  CHECK(count_at(other, 2) == negative_count(other));
  CHECK(count_at(problem.lower, 1) == negative_count(problem.lower));
  CHECK(count_at(other, 1) == negative_count(problem.lower));  // told to have the interior of the last one
  family.release();
  CHECK(count_at(other, 1) == negative_count(other));
}

TEST_CASE("inertia factor: ours is not reliable where it has pivots that it cannot delay, MUMPS is") {
  const Index border = 9;
  for (const double diagonal : {0.0, 1e-15}) {
    CAPTURE(diagonal);
    const SymmetricProblem problem = badly_grouped(20, diagonal);
    const InertiaFactor ours = factorise(multifrontal(), problem, border);
    const bool reliable = ours.regular && inexactness(ours, problem.lower, border) < reliable_inexactness;
    CHECK_FALSE(reliable);
    const InertiaFactor other = factorise(mumps(), problem, border);
    REQUIRE(other.regular);
    CHECK(inexactness(other, problem.lower, border) < 1e-12);
    CHECK(other.negative_eigenvalues == negative_count(problem.lower));
  }
}

TEST_CASE("inertia factor: a judge sees a wrong count, and is asked about reliable ones only") {
  const SymmetricProblem problem = saddle_point(30, 0.5, 0.7, 4);
  const auto off_by_one = [](const InertiaPattern& pattern) {
    const InertiaFamily right = multifrontal().analyse(pattern);
    return InertiaFamily{[right](const SparseMatrix& lower, const std::array<double, 2>& parameters) {
                           InertiaFactor factor = right.factorise(lower, parameters);
                           ++factor.negative_eigenvalues;
                           return factor;
                         },
                         right.release};
  };
  const auto verdict = std::make_shared<MumpsVerdict>();
  factorise(judged(multifrontal(), mumps(), verdict), problem, 6);
  CHECK(verdict->judged == 1);
  CHECK(verdict->differing == 0);
  factorise(judged({"off by one", off_by_one}, mumps(), verdict), problem, 6);
  CHECK(verdict->judged == 2);
  CHECK(verdict->differing == 1);
  factorise(judged(multifrontal(), mumps(), verdict), badly_grouped(20, 0), 9);
  factorise(judged(broken(), mumps(), verdict), problem, 6);
  CHECK(verdict->judged == 2);
  factorise(judged(multifrontal(), broken(), verdict), problem, 6);
  CHECK(verdict->undecided == 1);
}
