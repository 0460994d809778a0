// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/fclib_files.hpp"
#include "../support/matrices.hpp"
#include "linalg/random.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Matrix random_definite(RandomStream& random, Index n) {
  const Dense a = random_matrix(n, n, random);
  return a * a.transpose() + identity(n);
}

// Bodies with mass matrices of these sizes, in turn; each contact joins two unknowns of every body it draws.
GlobalFrictionProblem random_bodies(std::uint64_t seed, const std::vector<Index>& sizes, Index contacts) {
  RandomStream random(seed);
  Index dofs = 0;
  for (const Index size : sizes) dofs += size;
  Matrix mass = Matrix::Zero(dofs, dofs), h = Matrix::Zero(dofs, 2 * contacts);
  Index first = 0;
  for (const Index size : sizes) {
    mass.block(first, first, size, size) = random_definite(random, size);
    first += size;
  }
  for (Index j = 0; j < h.cols(); ++j)
    for (Index k = 0; k < 6; ++k) h(random.below(dofs), j) = random.normal();
  return {mass.sparseView(), h.sparseView(), random.normal_vector(dofs), random.normal_vector(2 * contacts),
          Vector::Constant(contacts, 0.3)};
}

std::string message(const auto& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("elimination of the velocities is H^T M^-1 H, for small and large pieces of M") {
  for (const auto& sizes : {std::vector<Index>{3, 3, 3, 3}, {1, 1, 1, 1, 1, 1}, {3, 50, 3, 40}, {70}}) {
    const GlobalFrictionProblem global = random_bodies(3, sizes, 5);
    const LocalFrictionProblem local = reduce(global);
    const Dense mass = global.mass, h = global.h;
    const Dense w = h.transpose() * solve(mass, h);
    CHECK((local.w - w).norm() < 1e-12 * w.norm());
    const Vector q = h.transpose() * solve(mass, global.f) + global.w;
    CHECK((local.q - q).norm() < 1e-12 * q.norm());
    CHECK(local.friction == global.friction);
    const Vector r = Vector::LinSpaced(10, -1, 1);
    const Vector v = body_velocities(global, r);
    CHECK((mass * v - h * r - global.f).norm() < 1e-11);
    CHECK((h.transpose() * v + global.w - local.w * r - local.q).norm() < 1e-11);
  }
}

TEST_CASE("W is as sparse as contacts that share a body") {
  // A chain of bodies: contact k joins bodies k and k + 1.
  const Index bodies = 20;
  Matrix mass = Matrix::Zero(3 * bodies, 3 * bodies), h = Matrix::Zero(3 * bodies, 2 * (bodies - 1));
  RandomStream random(9);
  for (Index b = 0; b < bodies; ++b) mass.block(3 * b, 3 * b, 3, 3) = random_definite(random, 3);
  for (Index c = 0; c + 1 < bodies; ++c)
    for (Index k = 0; k < 2; ++k) h.block(3 * c, 2 * c + k, 6, 1) = random.normal_vector(6);
  const GlobalFrictionProblem chain{mass.sparseView(), h.sparseView(), Vector::Zero(3 * bodies),
                                    Vector::Zero(2 * (bodies - 1)), Vector::Zero(bodies - 1)};
  CHECK(reduce(chain).w.nonZeros() == 4 * (3 * (bodies - 1) - 2));
}

TEST_CASE("problems that cannot be meant are refused, saying what was met") {
  const GlobalFrictionProblem good = random_bodies(1, {3, 3}, 2);
  const auto refused = [&](const auto& change) {
    GlobalFrictionProblem bad = good;
    change(bad);
    return message([&] { reduce(bad, "file"); });
  };
  CHECK(refused([](auto&) {}) == "no error");
  CHECK(refused([](auto& p) { p.f.conservativeResize(5); }) == "file: f: expected rows of M = 6 numbers, met 5");
  CHECK(refused([](auto& p) { p.w.conservativeResize(3); }) == "file: w: expected 2 x contacts = 4 numbers, met 3");
  CHECK(refused([](auto& p) { p.h = SparseMatrix(5, 4); }) == "file: H: expected a 6 x 4 matrix, met 5 x 4");
  CHECK(refused([](auto& p) { p.friction[1] = -0.5; }) ==
        "file: mu: expected coefficients of friction from 0 to 10000, met -0.5 for contact 1");
  CHECK(refused([](auto& p) { p.friction[0] = 1e9; }).find("met 1000000000") != std::string::npos);
  CHECK(refused([](auto& p) { p.f[2] = infinity; }) == "file: f: expected finite numbers, met inf at position 2");
  CHECK(refused([](auto& p) { p.mass.coeffRef(1, 1) = not_a_number; }).find("row 1, column 1") != std::string::npos);
  CHECK(refused([](auto& p) {
          p.mass = SparseMatrix(p.mass.template triangularView<Eigen::Upper>());
        }).find("symmetric matrix stored in full") != std::string::npos);
  CHECK(refused([](auto& p) {
          p.mass = SparseMatrix(p.mass.template triangularView<Eigen::Upper>());
        }).find("only the upper triangle") != std::string::npos);
  CHECK(refused([](auto& p) { p.mass.coeffRef(4, 4) = -1; }).find("piece of 3 unknown(s) that begins at row 3") !=
        std::string::npos);
  CHECK(refused([](auto& p) {
          for (Index i = 0; i < 6; ++i) p.h.coeffRef(i, 3) = 2 * p.h.coeff(i, 2);
        }).find("positive definite block for every contact") != std::string::npos);
}

TEST_CASE("symmetry is asked for as far as public files have it") {
  LocalFrictionProblem problem;
  problem.w = (Matrix(2, 2) << 2, 1, 1 + 9e-3, 2).finished().sparseView();
  problem.q = Vector::Zero(2);
  problem.friction = Vector::Zero(1);
  CHECK_NOTHROW(check(problem, "file"));
  problem.w.coeffRef(1, 0) = 1 + 1.1e-2;
  CHECK(message([&] { check(problem, "file"); }).find("file: W: expected a symmetric matrix") == 0);
  GlobalFrictionProblem bodies = random_bodies_problem(1, 2, 2);
  bodies.mass.coeffRef(0, 1) = 1.5e-5 * bodies.mass.diagonal().maxCoeff();
  CHECK(message([&] { check(bodies, "file"); }).find("file: M: expected a symmetric matrix") == 0);
}
