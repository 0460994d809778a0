// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/cut_contacts.hpp"

#include "../support/cut_lattice.hpp"
#include "../support/dense.hpp"
#include "two_stage/granular_two_stage.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("linear systems of contacts that are cut have the solutions of the whole ones") {
  RandomStream stream(3);
  using enum InterfacePreconditioner;
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{1, 1}, {2, 1}, {3, 2}})
    for (const bool slides : {false, true})
      for (const InterfacePreconditioner stage_two : {inertia, network, active}) {
        const Cut one = cut_lattice(grid);
        const Index contacts = one.parts.contacts / 2;
        const std::vector<ContactRelation<2>> relation = relations(contacts, 1e-3, slides);
        Matrix p = Matrix::Zero(2 * contacts, 2 * contacts), q = p;
        for (Index c = 0; c < contacts; ++c) {
          p.block<2, 2>(2 * c, 2 * c) = relation[at(c)].p;
          q.block<2, 2>(2 * c, 2 * c) = relation[at(c)].q;
        }
        const Vector b = random_vector(stream, 2 * contacts);
        const Vector expected = solve(p + Dense(q) * one.w, b);
        CutContacts<2> cut(one.parts, {.preconditioner = stage_two, .tolerance = 1e-13});
        REQUIRE(cut.factorise(relation));
        const Vector found = cut.solve(b);
        CHECK((found - expected).norm() < 1e-8 * expected.norm());
        CHECK(cut.work().failures == 0);
        CHECK((cut.work().iterations > 0) == (one.parts.interface_size() > 0));
        // S as a matrix is S as a map, and symmetric where no contact slides.
        if (one.parts.interface_size() == 0) continue;
        const Matrix s = cut.dense();
        const Vector f = random_vector(stream, s.rows());
        CHECK((s * f - cut.apply(f)).norm() < 1e-10 * s.norm() * f.norm());
        CHECK(((s - s.transpose()).norm() < 1e-10 * s.norm()) == !slides);
      }
}

TEST_CASE("lumped and Dirichlet preconditioners, and coarse spaces, find the same solutions in fewer iterations") {
  RandomStream stream(17);
  const Cut one = cut_lattice({3, 2});
  const Index contacts = one.parts.contacts / 2;
  for (const bool slides : {false, true}) {
    const std::vector<ContactRelation<2>> relation = relations(contacts, 1e-3, slides);
    const Vector b = random_vector(stream, 2 * contacts);
    using enum InterfacePreconditioner;
    const auto solve_with = [&](CutOptions options) {
      options.tolerance = 1e-12;
      CutContacts<2> cut(one.parts, options);
      REQUIRE(cut.factorise(relation));
      const Vector found = cut.solve(b);
      CHECK(cut.work().failures == 0);
      return std::pair{found, cut.work().iterations};
    };
    const auto [expected, by_inertia] = solve_with({.preconditioner = inertia});
    for (const Scaling scaling : {Scaling::multiplicity, Scaling::stiffness, Scaling::deluxe}) {
      const CutOptions of_lumped{.preconditioner = lumped, .scaling = scaling, .coarse_space = CoarseSpace::geneo};
      CHECK((solve_with(of_lumped).first - expected).norm() < 1e-8 * expected.norm());  // geneo has no effect
      const auto [found, iterations] = solve_with({.preconditioner = dirichlet, .scaling = scaling});
      CHECK((found - expected).norm() < 1e-8 * expected.norm());
      const auto [coarse, fewer] = solve_with(
          {.preconditioner = dirichlet, .scaling = scaling, .coarse_space = CoarseSpace::geneo, .kappa = 1.5});
      CHECK((coarse - expected).norm() < 1e-8 * expected.norm());
      if (!slides) {
        CHECK(iterations < by_inertia);
        CHECK(fewer < iterations);
      }
    }
  }
}

TEST_CASE("the sign of the determinant of systems that are cut is that of the whole ones") {
  RandomStream stream(13);
  std::array<int, 2> seen{};
  const Cut one = cut_lattice({3, 2});
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<ContactRelation<2>> relation = relations(one.parts.contacts / 2, 0.1, true);
    for (ContactRelation<2>& each : relation)  // sliding with frictions that turn the determinant now and then
      if (each.p(1, 0) != 0) each.p(1, 0) = 6 * random_of(stream);
    const Index size = one.parts.contacts;
    Matrix p = Matrix::Zero(size, size), q = p;
    for (Index c = 0; c < size / 2; ++c) {
      p.block<2, 2>(2 * c, 2 * c) = relation[at(c)].p;
      q.block<2, 2>(2 * c, 2 * c) = relation[at(c)].q;
    }
    const double expected = determinant(p + Dense(q) * one.w);
    CutContacts<2> cut(one.parts, {.tolerance = 1e-10});
    REQUIRE(cut.factorise(relation));
    cut.solve(random_vector(stream, size));
    CHECK(cut.determinant_sign() == (expected < 0 ? -1 : 1));
    ++seen[expected < 0 ? 0 : 1];
  }
  CHECK(seen[0] > 5);
  CHECK(seen[1] > 5);
}

TEST_CASE("on active contacts of equal flexibility Stage 2 is Stage 1, and one iteration does") {
  RandomStream stream(5);
  const Cut one = cut_lattice({3, 2});
  CutContacts<2> cut(one.parts, {.flexibility = 1, .tolerance = 1e-8});
  REQUIRE(cut.factorise(relations(one.parts.contacts / 2, 1e-2, false)));
  cut.solve(random_vector(stream, one.parts.contacts));
  CHECK(cut.work().iterations == 1);
}

TEST_CASE("iterations end with the solution, or say that they have not") {
  RandomStream stream(7);
  const Index n = 30;
  Matrix a(n, n);
  for (Index j = 0; j < n; ++j) a.col(j) = random_vector(stream, n);
  const Vector b = random_vector(stream, n);
  const LinearMap identity = [](const Vector& x) { return x; };
  const auto map = [](const Matrix& m) -> LinearMap { return [&m](const Vector& x) -> Vector { return m * x; }; };
  const Matrix normal = a.transpose() * a + Matrix::Identity(n, n), general = 8 * Matrix::Identity(n, n) + a;
  const auto judge = [&](const Matrix& m, const IteratedSolution& found, double tolerance) {
    const double residual = (b - m * found.x).norm() / b.norm();
    CHECK(found.residual == doctest::Approx(residual).epsilon(1e-3).scale(1e-12));
    CHECK(found.converged == (residual <= 1.01 * tolerance));
  };
  judge(normal, conjugate_gradients(map(normal), identity, b, {1e-10, 200}), 1e-10);
  judge(general, generalised_minimal_residuals(map(general), identity, b, {1e-10, 200}), 1e-10);
  judge(normal, conjugate_gradients(map(normal), identity, b, {1e-10, 4}), 1e-10);
  judge(general, generalised_minimal_residuals(map(general), identity, b, {1e-10, 4}), 1e-10);
  // As many iterations as there are eigenvalues.
  Vector values = Vector::Ones(n);
  values.tail(5).setConstant(3);
  const Matrix two = values.asDiagonal();
  CHECK(conjugate_gradients(map(two), identity, b, {1e-10, 200}).iterations == 2);
  CHECK(generalised_minimal_residuals(map(two), identity, b, {1e-10, 200}).iterations == 2);
  const IteratedSolution none = generalised_minimal_residuals(map(two), identity, Vector::Zero(n));
  CHECK(none.iterations == 0);
  CHECK(none.x.isZero(0));
}

TEST_CASE("the eigenvalues of a normal matrix say how many iterations it takes") {
  RandomStream stream(11);
  const Index n = 40;
  const Matrix basis = Matrix::NullaryExpr(n, n, [&] { return random_of(stream); });
  const Dense q = orthogonal_factor(basis);
  Matrix turning = Matrix::Zero(n, n);
  Eigen::VectorXcd eigenvalues(n);
  for (Index k = 0; k < n; k += 2) {
    const double re = 0.2 + 2 * stream.uniform(), im = stream.uniform();
    turning.block<2, 2>(k, k) << re, -im, im, re;
    eigenvalues[k] = {re, im};
    eigenvalues[k + 1] = {re, -im};
  }
  const Matrix normal = q * turning * q.transpose();
  const IterationLimits limits{1e-8, 200};
  const IteratedSolution found =
      generalised_minimal_residuals([&](const Vector& x) -> Vector { return normal * x; },
                                    [](const Vector& x) { return x; }, q.apply(Vector::Ones(n)), limits);
  CHECK(found.iterations > 15);
  CHECK(found.iterations < n);
  CHECK(predicted_iterations(eigenvalues, limits) == found.iterations);
}
