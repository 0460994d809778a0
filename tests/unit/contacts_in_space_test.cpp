// SPDX-License-Identifier: GPL-3.0-or-later
// Contact problems in space by every solver, their linear systems, whole and cut.
#include "../support/dense.hpp"
#include "../support/fclib_files.hpp"
#include "../support/literal_sweeps.hpp"
#include "../support/other_maker.hpp"
#include "../support/sanitized.hpp"
#include "contact_solvers/newton.hpp"
#include "linalg/random.hpp"
#include "linalg/threads.hpp"
#include "two_stage/cut_contacts.hpp"

#include <Eigen/Geometry>
#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr auto space_algorithms = {FrictionAlgorithm::automatic, FrictionAlgorithm::continuation,
                                   FrictionAlgorithm::newton,    FrictionAlgorithm::nlgs,
                                   FrictionAlgorithm::admm,      FrictionAlgorithm::accelerated};

Eigen::Vector3d of(const Vector& values, Index c) { return values.segment<3>(3 * c); }

// Largest violation of the laws, each written out.
double violation(const LocalFrictionProblem& problem, const Vector& r) {
  const Vector u = problem.w * r + problem.q;
  double worst = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const Eigen::Vector3d p = of(r, c), v = of(u, c);
    const double mu = problem.friction[c], slip = v.tail<2>().norm();
    for (const double one : {-p[0], -v[0], std::abs(p[0] * v[0]), p.tail<2>().norm() - mu * p[0],
                             std::abs(p.tail<2>().dot(v.tail<2>()) + mu * p[0] * slip)})
      worst = std::max(worst, one);
  }
  return worst;
}

// Projections alone, in small steps: r <- P(r - rho (u + mu |u_t| n)).
Vector by_projections(const LocalFrictionProblem& problem, Index steps) {
  const double rho = 0.5 / problem.w.norm();
  Vector r = Vector::Zero(problem.size());
  for (Index k = 0; k < steps; ++k) {
    const Vector u = problem.w * r + problem.q;
    for (Index c = 0; c < problem.contacts(); ++c) {
      const double mu = problem.friction[c];
      Eigen::Vector3d z = of(r, c) - rho * of(u, c);
      z[0] -= rho * mu * of(u, c).tail<2>().norm();
      const double size = z.tail<2>().norm();
      if (mu * size <= -z[0]) {
        z.setZero();
      } else if (size > mu * z[0]) {
        const double n = (z[0] + mu * size) / (1 + mu * mu);
        z << n, (mu * n / size) * z.tail<2>();
      }
      r.segment<3>(3 * c) = z;
    }
  }
  return r;
}

// A third of the contacts open, a third sticks, a third slides and turns.
std::vector<ContactRelation<3>> relations(RandomStream& random, Index contacts, double alpha) {
  std::vector<ContactRelation<3>> result;
  for (Index c = 0; c < contacts; ++c) {
    const double n = c % 3 == 0 ? -1.0 : 1.0, t = c % 3 == 1 ? 0.1 : 2.0;
    const LocalVector<3> z{n, {t * random.normal(), t * random.normal()}};
    const FrozenContact<3> frozen =
        frozen_contact(c % 3 == 1 ? LocalVector<3>{1, {0.01, 0}} : z, 0.3 + 0.2 * random.uniform());
    result.push_back(ContactRelation<3>::of(frozen, alpha, 0.8));
  }
  return result;
}

}  // namespace

TEST_CASE("every solver finds the impulses of spheres, which are those of small projected steps") {
  Index sliding = 0, sticking = 0, open = 0;
  for (std::uint64_t seed = 1; seed <= (sanitized ? 2 : 18); ++seed) {
    LocalFrictionProblem problem = reduce(random_spheres_problem(seed, 6, 9));
    problem.friction *= 2;  // some stick
    CAPTURE(seed);
    const FrictionSolution first = solve_friction(problem, {.algorithm = FrictionAlgorithm::nlgs, .tolerance = 1e-13});
    REQUIRE(first.status == FrictionStatus::converged);
    for (const FrictionAlgorithm algorithm : space_algorithms)
      for (const bool bodies : {true, false}) {
        CAPTURE(to_string(algorithm));
        LocalFrictionProblem one = problem;
        if (!bodies) one.mass = one.h = SparseMatrix();
        const FrictionSolution found = solve_friction(one, {.algorithm = algorithm, .tolerance = 1e-11});
        REQUIRE(found.status == FrictionStatus::converged);
        CHECK(violation(problem, found.impulses) < 1e-9);
        CHECK((found.impulses - first.impulses).norm() < 1e-8 * first.impulses.norm());
        CHECK(found.state.open + found.state.stick + found.state.slide == 9);
      }
    if (seed <= (sanitized ? 1 : 4))
      CHECK((by_projections(problem, 60'000) - first.impulses).norm() < 1e-6 * first.impulses.norm());
    open += first.state.open;
    sticking += first.state.stick;
    sliding += first.state.slide;
  }
  if (sanitized) return;
  CHECK(open > 10);
  CHECK(sticking > 4);
  CHECK(sliding > 10);
}

TEST_CASE("a plane problem in space has the solution of the plane by every solver") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const LocalFrictionProblem plane = reduce(random_bodies_problem(seed, 6, 8)), space = in_space(plane);
    check(space, "space");
    for (const FrictionAlgorithm algorithm : space_algorithms) {
      INFO("seed = ", seed, ", algorithm = ", to_string(algorithm));
      const FrictionSolution expected = solve_friction(plane, {.algorithm = algorithm, .tolerance = 1e-12});
      const FrictionSolution found = solve_friction(space, {.algorithm = algorithm, .tolerance = 1e-12});
      REQUIRE(expected.status == FrictionStatus::converged);
      REQUIRE(found.status == FrictionStatus::converged);
      for (Index c = 0; c < plane.contacts(); ++c) {
        const ContactStatus status = contact_status(component<2>(expected.impulses, c), plane.friction[c], 1e-9);
        const ContactStatus there = contact_status(component<3>(found.impulses, c), plane.friction[c], 1e-9);
        CHECK((status == ContactStatus::stick) == (there == ContactStatus::stick));
        CHECK(slides(status) == slides(there));
        CHECK((found.impulses.segment<2>(3 * c) - expected.impulses.segment<2>(2 * c)).norm() < 1e-10);
        CHECK(std::abs(found.impulses[3 * c + 2]) < 1e-12);
      }
    }
  }
}

TEST_CASE("few of Newton's steps, which turn sliding directions, solve a problem in space") {
  Index factorisations = 0;
  for (std::uint64_t seed = 1; seed <= (sanitized ? 1 : 10); ++seed) {
    const LocalFrictionProblem problem = reduce(random_spheres_problem(seed, 60, 130));
    const Vector guess =
        solve_friction(problem, {.algorithm = FrictionAlgorithm::nlgs, .tolerance = 1e-3, .check_every = 1}).impulses;
    const FrictionSolution found = solve_friction(
        problem, {.algorithm = FrictionAlgorithm::newton, .tolerance = 1e-12, .maximum_sweeps = 0}, guess);
    REQUIRE(found.status == FrictionStatus::converged);
    factorisations += found.factorisations;
  }
  CAPTURE(factorisations);
  CHECK(factorisations <= 100);  // 70 when written
}

TEST_CASE("linear systems of contacts in space: whole, with bodies as unknowns, and cut into subdomains") {
  RandomStream random(11);
  for (std::uint64_t seed = 1; seed <= (sanitized ? 2 : 6); ++seed) {
    const Index bodies = 12, contacts = 30;
    const GlobalFrictionProblem global = random_spheres_problem(seed, bodies, contacts);
    const LocalFrictionProblem problem = reduce(global);
    LocalFrictionProblem without = problem;
    without.mass = without.h = SparseMatrix();
    const std::vector<ContactRelation<3>> all = relations(random, contacts, 1e-3);
    const Matrix dense = literal_system(Matrix(problem.w), all);
    const Vector b = random.normal_vector(3 * contacts), expected = solve(Dense(dense), b);
    ContactMatrix<3> of_bodies(problem, problem.w), of_contacts(without, without.w);
    Partition partition{.subdomains = 3, .subdomain_of_contact = {}};
    for (Index column = 0; column < 3 * contacts; ++column)
      partition.subdomain_of_contact.push_back(column / 3 % bodies / 4);
    REQUIRE(of_bodies.factorise(all));
    REQUIRE(of_contacts.factorise(all));
    CHECK((of_bodies.solve(b) - expected).norm() < 1e-9 * expected.norm());
    CHECK((of_contacts.solve(b) - expected).norm() < 1e-9 * expected.norm());
    CHECK(of_bodies.determinant_sign() == (determinant(dense) < 0 ? -1 : 1));
    const Decomposition parts = decompose(reference_problem(global), partition);
    REQUIRE(parts.interface_size() > 0);
    using enum InterfacePreconditioner;
    for (const InterfacePreconditioner stage_two : {inertia, network, active}) {
      CutContacts<3> cut(parts, {.preconditioner = stage_two, .tolerance = 1e-13});
      REQUIRE(cut.factorise(all));
      CHECK((cut.solve(b) - expected).norm() < 1e-7 * expected.norm());
      CHECK(cut.work().failures == 0);
      // The same problem by Newton's method on systems that are cut.
      const FrictionSolution whole = solve_friction(problem, {.tolerance = 1e-10});
      CutContacts<3> of_newton(parts, {.preconditioner = stage_two, .tolerance = 1e-12});
      StoredContacts<3> stored(problem);
      OtherMaker<3, CutContacts<3>> of_cut{stored, of_newton};
      const FrictionSolverOptions options{.tolerance = 1e-10, .maximum_sweeps = 0};
      const FrictionObserver nobody;
      SolverRun<3> run(of_cut, options, 0.9 * whole.impulses, nobody);
      newton(of_cut, run);
      const FrictionSolution found = run.best();
      CHECK(found.status == FrictionStatus::converged);
      CHECK(found.factorisations > 0);
      CHECK((found.impulses - whole.impulses).norm() < 1e-6 * whole.impulses.norm());
    }
  }
}

TEST_CASE("H^T of spheres gives velocities at contacts, and none for a rigid motion") {
  RandomStream random(5);
  const auto vector = [&] { return Eigen::Vector3d(random.normal_vector(3)); };
  std::vector<Eigen::Vector3d> normals{{0, 0, 1}, {0, 0, -1}, {1, 0, -0.0}, {0, -1, 0}};
  for (int k = 0; k < 20; ++k) normals.push_back(vector().normalized());
  for (const Eigen::Vector3d& n : normals) {
    const auto [first, second] = tangents_of({n[0], n[1], n[2]});
    const Eigen::Vector3d t1(first.data()), t2(second.data());
    Eigen::Matrix3d frame;
    frame << n, t1, t2;
    CHECK((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm() < 1e-14);
    CHECK(n.cross(t1).dot(t2) == doctest::Approx(1));
    const double radius_a = 0.7, radius_b = 1.3;
    ConnectivityBuilder<3> builder(12, 3);
    for (const LocalVector<3>& direction : contact_directions<3>())
      builder.add({n[0], n[1], n[2]}, {0, radius_a}, {6, radius_b}, direction);
    const SparseMatrix h = builder.matrix();
    // The point of b at the contact as seen from that of a, with spins about the centres.
    const Eigen::Vector3d va = vector(), wa = vector(), vb = vector(), wb = vector();
    Vector motion(12);
    motion << va, wa, vb, wb;
    const Eigen::Vector3d relative = vb + wb.cross(-radius_b * n) - va - wa.cross(radius_a * n);
    CHECK((h.transpose() * motion - frame.transpose() * relative).norm() < 1e-13);
    const Eigen::Vector3d centre_b = (radius_a + radius_b) * n;
    motion << va, wa, va + wa.cross(centre_b), wa;
    CHECK((h.transpose() * motion).norm() < 1e-13);
  }
}

TEST_CASE("in space one iteration solves blocks that Stage 2 sees in every tangential direction") {
  RandomStream random(3);
  const Index bodies = 12, contacts = 30;
  std::vector<ContactRelation<3>> all(at(contacts));
  for (ContactRelation<3>& relation : all) {
    const Eigen::Vector2d axis = Eigen::Vector2d(random.normal_vector(2)).normalized();
    relation.q.bottomRightCorner<2, 2>() =
        Eigen::Matrix2d::Identity() / 2 + (1 + random.uniform()) * axis * axis.transpose();
    relation.q(0, 0) = 1 + random.uniform();
  }
  Partition partition{.subdomains = 3, .subdomain_of_contact = {}};
  for (Index column = 0; column < 3 * contacts; ++column)
    partition.subdomain_of_contact.push_back(column / 3 % bodies / 4);
  const Decomposition parts = decompose(reference_problem(random_spheres_problem(4, bodies, contacts)), partition);
  CutContacts<3> cut(parts, {.flexibility = 1, .tolerance = 1e-8});
  REQUIRE(cut.factorise(all));
  cut.solve(random.normal_vector(3 * contacts));
  CHECK(cut.work().iterations == 1);
}

TEST_CASE("orders and threads of sweeps in space, and a W that is not symmetric") {
  LocalFrictionProblem problem = reduce(random_spheres_problem(2, sanitized ? 60 : 200, sanitized ? 120 : 430));
  Vector alone;
  for (const Index threads : {1, 4}) {
    const ThreadLimit limit(threads);
    const Vector r =
        solve_friction(problem,
                       {.algorithm = FrictionAlgorithm::nlgs, .maximum_sweeps = 40, .order = SweepOrder::coloured})
            .impulses;
    if (threads == 1) alone = r;
    CHECK(r == alone);
  }
  for (Index j = 0; j < problem.w.cols(); ++j)
    for (SparseMatrix::InnerIterator e(problem.w, j); e; ++e)
      e.valueRef() *= 1 + 1e-4 * std::sin(3 * static_cast<double>(e.row()) + 7 * static_cast<double>(j));
  check(problem, "problem");
  problem.mass = problem.h = SparseMatrix();
  for (const FrictionAlgorithm algorithm : space_algorithms) {
    CAPTURE(to_string(algorithm));
    const FrictionSolution found = solve_friction(problem, {.algorithm = algorithm, .tolerance = 1e-9});
    CHECK(found.status == FrictionStatus::converged);
    CHECK(violation(problem, found.impulses) < 1e-7);
  }
}

TEST_CASE("problems in space are refused by their sizes and blocks") {
  const LocalFrictionProblem good = reduce(random_spheres_problem(1, 3, 4));
  const auto refused = [](const LocalFrictionProblem& problem, const char* message) {
    CHECK_THROWS_WITH_AS(check(problem, "p"), doctest::Contains(message), Error);
  };
  LocalFrictionProblem bad = good;
  bad.dimension = 2;
  refused(bad, "p: W: expected a 8 x 8 matrix, met 12 x 12");
  bad.dimension = 4;
  refused(bad, "p: dimension: expected 2 or 3, met 4");
  bad = good;
  bad.w.coeffRef(5, 5) = 0;
  refused(bad, "expected a positive definite block for every contact, met [");
  CHECK_THROWS_AS(solve_friction(good, {}, Vector::Zero(8)), Error);
}
