// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/fclib_files.hpp"
#include "../support/matrices.hpp"
#include "../support/problems.hpp"
#include "../support/sanitized.hpp"
#include "linalg/random.hpp"
#include "linalg/threads.hpp"
#include "mechanics/active_set.hpp"
#include "mechanics/contact_law.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

SparseMatrix sparse(const Matrix& dense) { return dense.sparseView(); }

// W = A A^T + shift, friction in [0, most).
LocalFrictionProblem random_problem(std::uint64_t seed, Index contacts, double most) {
  RandomStream random(seed);
  const Index size = 2 * contacts;
  const Dense a = random_matrix(size, size, random);
  LocalFrictionProblem problem{sparse(a * a.transpose() / static_cast<double>(size) + 0.3 * identity(size)),
                               random.normal_vector(size), Vector(contacts)};
  for (Index c = 0; c < contacts; ++c) problem.friction[c] = most * random.uniform();
  return problem;
}

bool obeys(const LocalFrictionProblem& problem, const Vector& r, const Vector& u, double tolerance) {
  for (Index c = 0; c < problem.contacts(); ++c) {
    const double n = r[2 * c], t = r[2 * c + 1], u_n = u[2 * c], u_t = u[2 * c + 1], mu = problem.friction[c];
    if (n < -tolerance || u_n < -tolerance || std::abs(n * u_n) > tolerance) return false;
    if (std::abs(t) > mu * n + tolerance) return false;
    // Power of friction: as negative as the cone allows.
    if (std::abs(u_t * t + mu * n * std::abs(u_t)) > tolerance) return false;
  }
  return true;
}

// Every solution, by trying the 4^c combinations of statuses: the equations of a combination are linear.
std::vector<Vector> every_solution(const LocalFrictionProblem& problem) {
  const Index c = problem.contacts(), size = 2 * c;
  const Matrix w = problem.w;
  std::vector<Vector> found;
  for (Index code = 0; code < Index{1} << (2 * c); ++code) {
    Matrix a = Matrix::Zero(size, size);
    Vector b = Vector::Zero(size);
    for (Index k = 0; k < c; ++k) {
      const Index status = (code >> (2 * k)) & 3;
      for (const Index row : {2 * k, 2 * k + 1}) {
        if (status == 0) {
          a(row, row) = 1;  // open: r = 0
        } else if (status == 1 || row == 2 * k) {
          a.row(row) = w.row(row);  // stick: u = 0; slide: u_n = 0
          b[row] = -problem.q[row];
        } else {
          a(row, row) = 1;  // slide: r_t = -+ friction r_n
          a(row, row - 1) = status == 2 ? problem.friction[k] : -problem.friction[k];
        }
      }
    }
    const Vector r = least_norm_solution(a, b);
    if (!r.allFinite() || !obeys(problem, r, w * r + problem.q, 1e-11)) continue;
    const auto is_r = [&](const Vector& other) { return (other - r).norm() < 1e-8; };
    if (std::ranges::none_of(found, is_r)) found.push_back(r);
  }
  return found;
}

}  // namespace

constexpr auto algorithms = {FrictionAlgorithm::automatic, FrictionAlgorithm::continuation,
                             FrictionAlgorithm::newton,    FrictionAlgorithm::nlgs,
                             FrictionAlgorithm::admm,      FrictionAlgorithm::accelerated};
static_assert(algorithms.size() == names_of(FrictionAlgorithm{}).size());

// A problem with a solution that is made first. W has rank `rank`: below 2 x contacts it is hyperstatic. Half of the
// contacts are without friction where `frictionless`.
LocalFrictionProblem solvable_problem(std::uint64_t seed, Index contacts, Index rank, bool frictionless) {
  RandomStream random(seed);
  const Dense a = random_matrix(2 * contacts, rank, random);
  Vector r = Vector::Zero(2 * contacts), u = r;
  LocalFrictionProblem problem{sparse(a * a.transpose() / static_cast<double>(rank)), {}, Vector::Zero(contacts)};
  for (Index c = 0; c < contacts; ++c) {
    const double mu = problem.friction[c] = frictionless && c % 2 == 0 ? 0.0 : 0.1 + 0.5 * random.uniform();
    const double side = random.uniform() < 0.5 ? -1 : 1;
    const Index status = random.below(3);
    if (status > 0) r[2 * c] = 0.1 + random.uniform();
    if (status == 0) u[2 * c] = 0.1 + random.uniform();
    if (status == 1) r[2 * c + 1] = 0.8 * side * mu * r[2 * c];  // sticks, or slides at no speed without friction
    if (status == 2) r[2 * c + 1] = -side * mu * r[2 * c];
    if (status != 1) u[2 * c + 1] = side * (0.1 + random.uniform());
  }
  problem.q = u - problem.w * r;
  return problem;
}

TEST_CASE("every solver finds a solution that enumeration of all statuses finds") {
  constexpr std::uint64_t seeds = 60;
  const auto problem_of = [](std::uint64_t seed) {
    return random_problem(seed, 1 + static_cast<Index>(seed % 4), 0.5);
  };
  std::vector<std::vector<Vector>> all;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) all.push_back(every_solution(problem_of(seed)));
  for (const FrictionAlgorithm algorithm : algorithms) {
    Index unique = 0, sliding = 0, sticking = 0, open = 0;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const LocalFrictionProblem problem = problem_of(seed);
      const Index contacts = problem.contacts();
      check(problem, "problem");
      const std::vector<Vector>& solutions = all[seed - 1];
      REQUIRE_FALSE(solutions.empty());
      const FrictionSolution found = solve_friction(problem, {.algorithm = algorithm, .tolerance = 1e-12});
      INFO("seed = ", seed, ", algorithm = ", to_string(algorithm));
      REQUIRE(found.status == FrictionStatus::converged);
      double nearest = infinity;
      for (const Vector& solution : solutions) {
        nearest = std::min(nearest, (solution - found.impulses).norm());
        CHECK(friction_state(problem, solution).residual < 1e-11);
      }
      CHECK(nearest < 1e-9);
      CHECK(found.state.open + found.state.stick + found.state.slide == contacts);
      unique += solutions.size() == 1;
      open += found.state.open;
      sticking += found.state.stick;
      sliding += found.state.slide;
    }
    CHECK(unique > 50);
    CHECK(open > 10);
    CHECK(sticking > 5);
    CHECK(sliding > 10);
  }
}

TEST_CASE("hyperstatic problems are solved, and contacts without friction among others") {
  for (const FrictionAlgorithm algorithm : {FrictionAlgorithm::automatic, FrictionAlgorithm::continuation,
                                            FrictionAlgorithm::newton, FrictionAlgorithm::admm}) {
    Index failed = 0;
    for (std::uint64_t seed = 1; seed <= (sanitized ? 12 : 40); ++seed) {
      const Index contacts = 2 + static_cast<Index>(seed);
      const LocalFrictionProblem problem =
          solvable_problem(seed, contacts, seed % 2 == 0 ? 2 * contacts : contacts + 1, seed % 3 == 0);
      INFO("seed = ", seed, ", algorithm = ", to_string(algorithm));
      const FrictionSolution found = solve_friction(problem, {.algorithm = algorithm, .tolerance = 1e-10});
      if (found.status != FrictionStatus::converged) {
        ++failed;
        continue;
      }
      CHECK(obeys(problem, found.impulses, problem.w * found.impulses + problem.q, 1e-7));
      const FrictionSolution again = solve_friction(problem, {.algorithm = algorithm, .tolerance = 1e-10});
      CHECK(again.impulses == found.impulses);  // bit for bit
      CHECK(again.factorisations == found.factorisations);
    }
    CHECK(failed <= (algorithm == FrictionAlgorithm::admm ? 1 : 0));  // one runs out of iterations
  }
}

TEST_CASE("a W of six digits, which is not symmetric, is solved as it was given") {
  LocalFrictionProblem problem = solvable_problem(9, 25, 60, false);
  for (int j = 0; j < problem.w.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(problem.w, j); e; ++e) e.valueRef() *= 1 + 1e-6 * std::sin(3 * e.row() + 7 * j);
  check(problem, "problem");
  for (const FrictionAlgorithm algorithm :
       {FrictionAlgorithm::automatic, FrictionAlgorithm::continuation, FrictionAlgorithm::newton}) {
    CAPTURE(to_string(algorithm));
    const FrictionSolution found = solve_friction(problem, {.algorithm = algorithm, .tolerance = 1e-11});
    CHECK(found.status == FrictionStatus::converged);
    CHECK(found.sweeps <= 2000);
    CHECK(found.factorisations <= 60);
  }
}

TEST_CASE("the curve of a smoothed law is short on hyperstatic problems, from zero and from sweeps") {
  Index cold = 0, warm = 0;
  for (std::uint64_t seed = 1; seed <= (sanitized ? 1 : 8); ++seed) {
    const LocalFrictionProblem problem = solvable_problem(seed, 100, 110, false);
    const FrictionSolverOptions options{.algorithm = FrictionAlgorithm::continuation, .tolerance = 1e-9};
    const FrictionSolution found = solve_friction(problem, options);
    CHECK(found.status == FrictionStatus::converged);
    cold += found.factorisations;
    const FrictionSolverOptions sweeps{.algorithm = FrictionAlgorithm::nlgs, .maximum_sweeps = 100};
    warm += solve_friction(problem, options, solve_friction(problem, sweeps).impulses).factorisations;
  }
  CHECK(cold <= 190);  // 163 and 131 when written
  CHECK(warm <= 155);
}

TEST_CASE("auto leaves very many contacts to accelerated sweeps" * doctest::skip(sanitized)) {
  constexpr Index contacts = 100'000;
  SparseMatrix w(2 * contacts, 2 * contacts);
  w.setIdentity();
  RandomStream random(7);
  const LocalFrictionProblem problem{w, random.normal_vector(2 * contacts), Vector::Constant(contacts, 0.4)};
  const FrictionSolution found = solve_friction(problem, {.tolerance = 1e-9});
  const FrictionSolution momentum =
      solve_friction(problem, {.algorithm = FrictionAlgorithm::accelerated, .tolerance = 1e-9});
  CHECK(found.status == FrictionStatus::converged);
  CHECK((found.sweeps == momentum.sweeps && found.impulses == momentum.impulses));
  const FrictionSolution sweeps = solve_friction(problem, {.algorithm = FrictionAlgorithm::nlgs, .tolerance = 1e-9});
  CHECK((found.impulses - sweeps.impulses).norm() <= 1e-8 * sweeps.impulses.norm());
  CHECK(found.sweeps != sweeps.sweeps);

  const FrictionSolution steps = solve_friction(problem, {.tolerance = 1e-9, .maximum_sweeps = 0});
  CHECK(steps.status == FrictionStatus::converged);  // without a sweep there are still Newton's steps
  CHECK(steps.factorisations > 0);
}

TEST_CASE("continuation needs no sweeps, and nothing but a judgement where the guess solves") {
  const LocalFrictionProblem problem = solvable_problem(3, 30, 40, false);
  const FrictionSolverOptions curve{.algorithm = FrictionAlgorithm::continuation, .tolerance = 1e-10};
  const FrictionSolution found = solve_friction(problem, curve);
  REQUIRE(found.status == FrictionStatus::converged);
  CHECK(found.sweeps == 0);
  CHECK(found.factorisations > 3);
  CHECK(found.factorisations < 60);
  const FrictionSolution again = solve_friction(problem, curve, found.impulses);
  CHECK((again.factorisations == 0 && again.impulses == found.impulses));
  const FrictionSolution lifted = solve_friction(problem, curve, 1e-9 * found.impulses);  // next to no guess
  CHECK(lifted.status == FrictionStatus::converged);
  CHECK(lifted.factorisations <= 2 * found.factorisations);
  LocalFrictionProblem parting = problem;  // all contacts part
  for (Index c = 0; c < 30; ++c) parting.q[2 * c] = 1;
  CHECK(solve_friction(parting, curve).impulses == Vector::Zero(60));
}

TEST_CASE("auto begins again from zero where a guess leads nowhere, and keeps what is better") {
  for (const std::uint64_t seed : {1U, 7U, 9U}) {
    CAPTURE(seed);
    const LocalFrictionProblem problem = solvable_problem(seed, 40, 44, false);
    FrictionSolverOptions options{.tolerance = 1e-9, .maximum_sweeps = 0};
    const FrictionSolution cold = solve_friction(problem, options);
    options.maximum_factorisations = 2 * cold.factorisations;
    const Vector guess = RandomStream(seed + 1000).normal_vector(80);
    const FrictionSolution found = solve_friction(problem, options, guess);
    CHECK(found.status == FrictionStatus::converged);
    CHECK((found.factorisations == options.maximum_factorisations && found.impulses == cold.impulses));

    options.maximum_factorisations = 3;
    const Vector near = cold.impulses + 0.1 * guess;
    const FrictionSolution kept = solve_friction(problem, options, near);
    REQUIRE(kept.status == FrictionStatus::maximum_reached);
    CHECK(kept.factorisations == 3);
    CHECK(kept.state.driven_residual <= friction_state(problem, near).driven_residual);
  }
}

TEST_CASE("what a solver without a solution ends with is its best and a status, within its limits") {
  // A grain is driven into a wall: both contacts ask for impulses that cancel.
  const LocalFrictionProblem squeezed = squeezed_grain();
  for (const FrictionAlgorithm algorithm : algorithms) {
    CAPTURE(to_string(algorithm));
    const FrictionSolution found =
        solve_friction(squeezed, {.algorithm = algorithm, .maximum_sweeps = 5000, .maximum_factorisations = 50});
    CHECK(found.status != FrictionStatus::converged);
    CHECK(found.impulses.allFinite());
    CHECK(found.sweeps <= 5000);
    CHECK(found.factorisations <= 50);
    CHECK(found.state.worst >= 0);
    CHECK(found.impulses.norm() < 1e9);
    if (found.factorisations == 50) CHECK(found.status == FrictionStatus::maximum_reached);
  }
}

TEST_CASE("what has converged obeys the law, also where next to every problem has no solution") {
  Index converged = 0, others = 0;
  for (std::uint64_t seed = 1; seed <= (sanitized ? 15 : 150); ++seed) {
    // Rigid bodies between walls: contacts at random, W of low rank, nothing that makes a solution exist.
    RandomStream random(seed);
    const Index bodies = 1 + random.below(4), contacts = 2 + random.below(7);
    Matrix h = Matrix::Zero(2 * contacts, 3 * bodies);
    for (Index c = 0; c < contacts; ++c) {
      const double angle =
          seed % 2 == 0 ? 1.5707963267948966 * static_cast<double>(random.below(4)) : 7 * random.uniform();
      const auto add = [&](Index body, double sign) {
        h.block(2 * c, 3 * body, 2, 2) << sign * std::cos(angle), sign * std::sin(angle), -sign * std::sin(angle),
            sign * std::cos(angle);
        h(2 * c + 1, 3 * body + 2) = 1;
      };
      const Index body = random.below(bodies);
      add(body, 1);
      if (bodies > 1 && random.uniform() < 0.5) add((body + 1) % bodies, -1);
    }
    LocalFrictionProblem problem{sparse(h * h.transpose()), random.normal_vector(2 * contacts),
                                 Vector::Constant(contacts, seed % 5 == 0 ? 0.0 : 0.3 * static_cast<double>(seed % 5))};
    for (const FrictionAlgorithm algorithm :
         {FrictionAlgorithm::automatic, FrictionAlgorithm::continuation, FrictionAlgorithm::newton}) {
      INFO("seed = ", seed, ", algorithm = ", to_string(algorithm));
      const FrictionSolution found =
          solve_friction(problem, {.algorithm = algorithm, .maximum_sweeps = 20'000, .maximum_factorisations = 200});
      ++(found.status == FrictionStatus::converged ? converged : others);
      if (found.status != FrictionStatus::converged) continue;
      const double size = 1 + found.impulses.norm();
      CHECK(obeys(problem, found.impulses, problem.w * found.impulses + problem.q, 1e-6 * size));
      CHECK(found.state.residual <= 1e-8);
    }
  }
  CHECK(converged > (sanitized ? 5 : 100));
  CHECK(others > (sanitized ? 0 : 20));
}

TEST_CASE("every solver: no contact, one, no friction, all slide, singular W, no numbers") {
  const auto solve = [](const LocalFrictionProblem& problem, FrictionAlgorithm algorithm) {
    const FrictionSolution found = solve_friction(problem, {.algorithm = algorithm, .tolerance = 1e-11});
    CHECK(found.status == FrictionStatus::converged);
    CHECK(obeys(problem, found.impulses, problem.w * found.impulses + problem.q, 1e-8));
    return found;
  };
  const LocalFrictionProblem one{sparse(Matrix{{2, 0}, {0, 3}}), Vector{{-4, 1}}, Vector::Constant(1, 0.1)};
  LocalFrictionProblem smooth = random_problem(3, 6, 0.4), sliding = random_problem(4, 6, 0.0);
  smooth.friction.setZero();
  for (Index c = 0; c < 6; ++c) {
    sliding.friction[c] = 0.05;
    sliding.q.segment<2>(2 * c) << -1, (c % 2 == 0 ? 20 : -20);
  }
  const LocalFrictionProblem thrice{sparse(Matrix(one.w).replicate(3, 3)), one.q.replicate(3, 1),
                                    Vector::Constant(3, 0.1)};  // the same contact three times
  for (const FrictionAlgorithm algorithm : algorithms) {
    CAPTURE(to_string(algorithm));
    CHECK(solve({SparseMatrix(0, 0), Vector(0), Vector(0)}, algorithm).impulses.size() == 0);
    const Vector r = solve(one, algorithm).impulses;  // it slides: r_t = -mu r_n
    CHECK(r[0] == doctest::Approx(2));
    CHECK(r[1] == doctest::Approx(-0.2));
    const Vector normal = solve(smooth, algorithm).impulses;
    for (Index c = 0; c < 6; ++c) CHECK(normal[2 * c + 1] == 0);
    CHECK(normal.norm() > 0.1);
    const Vector slid = solve(sliding, algorithm).impulses;  // on the edges of their cones, to rounding
    for (Index c = 0; c < 6; ++c) CHECK(std::abs(slid[2 * c + 1]) == doctest::Approx(0.05 * slid[2 * c]));
    CHECK(slid.norm() > 0.1);
    const Vector shared = solve(thrice, algorithm).impulses;
    CHECK(shared[0] + shared[2] + shared[4] == doctest::Approx(2));
    const Vector nothing = Vector::Constant(2, not_a_number);
    CHECK(solve_friction(one, {.algorithm = algorithm}, nothing).status == FrictionStatus::not_finite);
  }
}

TEST_CASE("every solver: the same bits again, and work that is counted") {
  const LocalFrictionProblem problem = solvable_problem(5, 40, 90, true);
  for (const FrictionAlgorithm algorithm : algorithms) {
    CAPTURE(to_string(algorithm));
    const FrictionSolution found = solve_friction(problem, {.algorithm = algorithm});
    CHECK(found.status == FrictionStatus::converged);
    CHECK(found.impulses == solve_friction(problem, {.algorithm = algorithm}).impulses);
    CHECK(found.operations > static_cast<double>(problem.w.nonZeros()));
    CHECK(found.sweeps + found.factorisations > 0);
    CHECK(solve_friction(problem, {.algorithm = algorithm}, found.impulses).operations == 0);
  }
}

TEST_CASE("what carries the residual, and whose statuses change, is named") {
  // Contacts by themselves. The first two are solved; of the squares left the last holds 64 / 74, the third 9.
  LocalFrictionProblem apart{sparse(Matrix::Identity(10, 10)), Vector::Zero(10), Vector::Zero(5)};
  for (Index c = 2; c < 5; ++c) apart.q[2 * c] = c == 2 ? -3 : c == 3 ? -1 : -8;
  FrictionSolution none;
  none.impulses = Vector::Zero(10);
  none.state = friction_state(apart, none.impulses);
  CHECK(contacts_with_residual(apart, none, 0.8) == std::vector<Index>{4});
  CHECK(contacts_with_residual(apart, none, 0.9) == std::vector<Index>{4, 2});
  CHECK(contacts_with_residual(apart, none, 1).size() == 3);
  const FrictionSolution at_once = solve_friction(apart, {.algorithm = FrictionAlgorithm::nlgs});
  CHECK(at_once.unsettled == std::vector<Index>{2, 3, 4});  // which closed in the first sweeps
  CHECK(contacts_with_residual(apart, at_once, 0.9).empty());
  CHECK(solve_friction(apart, {.algorithm = FrictionAlgorithm::nlgs}, at_once.impulses).unsettled.empty());
}

TEST_CASE("an observer stops every solver, and the best impulses remain") {
  const LocalFrictionProblem problem = solvable_problem(5, 40, 50, false);
  double alone = 0;  // || r^1 ||
  for (Index c = 0; c < problem.contacts(); ++c) {
    const FullDelassus<2> w = diagonal_block<2>(problem, c);
    const LocalVector<2> stop = w.solve({-problem.q[2 * c], -problem.q[2 * c + 1]});
    alone += squared(Coulomb{}.impulse(stop, w, problem.friction[c]));
  }
  alone = std::sqrt(alone);
  const auto natural_maps = [&](const FrictionSolution& one) {
    return one.state.residual * std::max(one.impulses.norm(), alone);
  };
  for (const FrictionAlgorithm algorithm : algorithms)
    for (const Index sweeps : {0, 1000}) {  // without sweeps `auto` is on the curve by then
      const bool on_curve = algorithm == FrictionAlgorithm::automatic || algorithm == FrictionAlgorithm::continuation;
      if (!on_curve && sweeps == 0) continue;
      CAPTURE(to_string(algorithm));
      Index checks = 0;
      double least = infinity;
      const FrictionSolution found =
          solve_friction(problem, {.algorithm = algorithm, .tolerance = 1e-14, .maximum_sweeps = sweeps}, {},
                         [&](const FrictionSolution& check) {
                           least = std::min(least, natural_maps(check));
                           return ++checks < 4;
                         });
      CHECK(found.status == FrictionStatus::stopped);
      CHECK(checks == 4);
      if (algorithm != FrictionAlgorithm::nlgs) CHECK(natural_maps(found) <= least * (1 + 1e-12));
    }
}

TEST_CASE("one contact: the local solution obeys the law for any friction, on the edge of the cone too") {
  RandomStream random(5);
  for (Index k = 0; k < 4000; ++k) {
    const double nn = 0.1 + random.uniform(), tt = 0.1 + random.uniform();
    const FullDelassus<2> w{nn, (2 * random.uniform() - 1) * 0.999 * std::sqrt(nn * tt), tt};
    const double friction = k % 5 == 0 ? 0.0 : 6 * random.uniform() * random.uniform();
    LocalVector<2> stop{random.normal(), random.normal()};
    if (k % 3 == 0)
      stop = {std::abs(stop.n), friction * std::abs(stop.n) * (1 + 1e-16 * static_cast<double>(k % 7 - 3))};
    if (k % 6 == 0) stop.t = std::nextafter(stop.t, k % 4 == 0 ? 100.0 : -100.0);
    const LocalVector<2> r = Coulomb{}.impulse(stop, w, friction);
    const LocalVector<2> v = w.apply({r.n - stop.n, r.t - stop.t});
    const LocalVector<2> m = natural_map(r, v, friction, 1 / nn);
    CAPTURE(k);
    // Where W is nearly singular the slip velocity loses digits with n = -free_n / (W_nn + s W_nt).
    CHECK(std::hypot(m.n, m.t) <= 1e-9 * (1 + std::hypot(r.n, r.t)));
    if (w.apply(stop).n > 1e-9) CHECK(r.n > 0);    // a contact that closes never opens
    if (w.apply(stop).n < -1e-9) CHECK(r.n == 0);  // one that opens does, also where rest would be a solution
  }
}

TEST_CASE("sweeps: a contact of a full block that opens stays open, though rest would be a solution, too") {
  // The second contact closes, so that sweeps are asked for.
  Matrix w = Matrix::Identity(4, 4);
  w(0, 1) = w(1, 0) = -0.9;
  const LocalFrictionProblem problem{sparse(w), Vector{{0.35, -0.6, -1, 0}}, Vector{{2, 2}}};
  const FrictionSolution found = solve_friction(problem, {.algorithm = FrictionAlgorithm::nlgs});
  CHECK(found.status == FrictionStatus::converged);
  CHECK(found.impulses.head(2).isZero(0));
  CHECK(found.impulses[2] == doctest::Approx(1));
}

TEST_CASE("alternating directions take the same way with contacts and with bodies as unknowns") {
  const LocalFrictionProblem problem = reduce(random_bodies_problem(4, 20, 60));
  LocalFrictionProblem without = problem;
  without.mass = without.h = SparseMatrix();
  const FrictionSolverOptions options{.algorithm = FrictionAlgorithm::admm, .maximum_sweeps = 100};
  const FrictionSolution bodies = solve_friction(problem, options), contacts = solve_friction(without, options);
  CHECK(contacts.sweeps == 100);
  CHECK(contacts.state.residual < 0.1);
  CHECK((bodies.impulses - contacts.impulses).norm() <= 1e-8 * contacts.impulses.norm());
  CHECK(bodies.operations < contacts.operations);  // fewer entries
}

TEST_CASE("projection on the cone: the nearest point of it, for no friction too") {
  RandomStream random(8);
  for (Index k = 0; k < 300; ++k) {
    const double friction = k % 3 == 0 ? 0.0 : 2 * random.uniform();
    const LocalVector<2> point{random.normal(), k % 4 == 0 ? 0.0 : random.normal()};
    const LocalVector<2> p = project_on_cone(point, friction);
    CHECK(p.n >= 0);
    CHECK(std::abs(p.t) <= friction * p.n * (1 + 1e-15));
    const double distance = std::hypot(point.n - p.n, point.t - p.t);
    for (const double slope : {-friction, -friction / 2, 0.0, friction})
      for (const double n : {0.0, 0.5 * p.n, 0.999 * p.n, 1.001 * p.n, 1e-3, 2.0})
        CHECK(std::hypot(point.n - n, point.t - slope * n) >= distance - 1e-15);
  }
}

TEST_CASE("order and relaxation lead to the same solution, a guess that solves needs no sweep") {
  const LocalFrictionProblem problem = random_problem(12, 4, 0.4);
  REQUIRE(every_solution(problem).size() == 1);
  FrictionSolverOptions options{.tolerance = 1e-12};
  const FrictionSolution plain = solve_friction(problem, options);
  for (const double relaxation : {0.7, 1.2})
    for (const std::string& order : all_names<SweepOrder>()) {
      CAPTURE(order);
      options.relaxation = relaxation;
      options.order = order;
      const FrictionSolution other = solve_friction(problem, options);
      CHECK(other.status == FrictionStatus::converged);
      CHECK((other.impulses - plain.impulses).norm() < 1e-10);
    }
  const FrictionSolution again = solve_friction(problem, {}, plain.impulses);
  CHECK((again.sweeps == 0 && again.impulses == plain.impulses));
}

TEST_CASE("without friction it is the unilateral problem") {
  Case squeezed = random_lattice(4, 6, 6, {1, 1});
  squeezed.spec.prescribed.clear();
  squeezed.spec.loads.compression = {1.0, 0.3};
  const ReferenceProblem reference = build(squeezed).problem;
  const SparseMatrix w = reference.h.transpose() * reference.inertia.cwiseInverse().asDiagonal() * reference.h;
  const Index contacts = reference.contacts();
  const auto normal = Eigen::seqN(0, contacts, 2);  // tangential parts are by themselves
  Matrix with_tangents = Matrix::Identity(2 * contacts, 2 * contacts);
  with_tangents(normal, normal) = Matrix(w);
  LocalFrictionProblem problem{sparse(with_tangents), Vector::Zero(2 * contacts), Vector::Zero(contacts)};
  problem.q(normal) = reference.h.transpose() * reference.arriving_velocity;
  const FrictionSolution found = solve_friction(problem, {.tolerance = 1e-12});
  INFO("found.state.residual = ", found.state.residual, ", found.sweeps = ", found.sweeps);
  REQUIRE(found.status == FrictionStatus::converged);
  const UnilateralImpulses expected = unilateral_impulses(reference);
  REQUIRE(expected.converged);
  for (Index c = 0; c < contacts; ++c)
    CHECK(found.state.velocities[2 * c] == doctest::Approx(expected.separation[c]).epsilon(1e-6).scale(1));
  CHECK(found.state.stick == 0);
}

TEST_CASE("Siconos' residual: rho = 1, relative to the largest of r, u and q") {
  LocalFrictionProblem problem{sparse(Matrix{{2, 0}, {0, 3}}), Vector{{-3, 4}}, Vector::Constant(1, 0.5)};
  // r = 0: u = q; r - rho (u + mu |u_t| n) = (3 - 2, -4) projects to (1 + 0.5 4)/(1.25) (1, -0.5).
  const FrictionState state = friction_state(problem, Vector::Zero(2));
  CHECK(state.siconos_residual == doctest::Approx(2.4 * std::sqrt(1.25) / 5));
  // rho = 1/2: (0.5, -2) projects to 1.2 (1, -0.5); alone the contact takes (1.5, -0.75).
  CHECK(state.residual == doctest::Approx(1.2 / 1.5));
  CHECK((state.velocities == problem.q && state.open == 1));
  // r = (10, 0): u = (17, 4), and r - (u + mu |u_t| n) = (-9, -4) projects to zero.
  const FrictionState pressed = friction_state(problem, Vector{{10, 0}});
  CHECK(pressed.siconos_residual == doctest::Approx(10 / std::hypot(17, 4)));
  CHECK(pressed.stick == 1);
  CHECK(pressed.siconos_relative);
  // Numbers below the rounding of 1 are not divided by: the residual is then absolute, and small.
  problem.q *= 1e-17;
  const FrictionState tiny = friction_state(problem, Vector::Zero(2));
  CHECK_FALSE(tiny.siconos_relative);
  CHECK(tiny.siconos_residual == doctest::Approx(2.4e-17 * std::sqrt(1.25)));
}

TEST_CASE("sweeps that get on, however slowly, have not stalled") {
  // A grain that two contacts brake: each sweep lets both impulses grow by 1 m/s over W_tt, until the contacts slide.
  const LocalFrictionProblem slow{sparse(Matrix{{1, 0, 0, 0}, {0, 1, 0, -1}, {0, 0, 1, 0}, {0, -1, 0, 1}}),
                                  Vector{{-1e4, -1, -1e4, -1}}, Vector::Constant(2, 0.1)};
  double least = infinity, most = 0;
  const FrictionSolution found =
      solve_friction(slow, {.algorithm = FrictionAlgorithm::nlgs, .check_every = 1, .patience = 20}, {},
                     [&](const FrictionSolution& check) {
                       if (check.sweeps > 10 && check.sweeps < 490) {
                         least = std::min(least, check.state.residual);
                         most = std::max(most, check.state.residual);
                       }
                       return true;
                     });
  CHECK(least > 0.99 * most);  // nothing shows that they get on
  CHECK(found.status == FrictionStatus::converged);
  CHECK(found.sweeps > 490);
  CHECK(found.impulses[1] == doctest::Approx(1e3));
}

TEST_CASE("sweeps that go round and round have stalled, and are ended soon") {
  Index stalled = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    const FrictionSolverOptions options{
        .algorithm = FrictionAlgorithm::nlgs, .maximum_sweeps = 500'000, .relaxation = 1.9};
    const FrictionSolution found = solve_friction(random_problem(seed, 2 + static_cast<Index>(seed % 5), 10), options);
    CHECK(found.status != FrictionStatus::maximum_reached);
    if (found.status != FrictionStatus::stalled) continue;
    ++stalled;
    CHECK(found.sweeps >= options.patience * options.check_every);
  }
  CHECK(stalled >= 5);
}

TEST_CASE("what came of the sweeps is said") {
  const LocalFrictionProblem problem = random_problem(7, 20, 0.4);
  SUBCASE("maximum") {
    const FrictionSolution found =
        solve_friction(problem, {.algorithm = FrictionAlgorithm::nlgs, .tolerance = 1e-15, .maximum_sweeps = 3});
    CHECK(found.status == FrictionStatus::maximum_reached);
    CHECK(found.sweeps == 3);
  }
  SUBCASE("stalled: a tolerance below rounding, and more factorisations than all turns take") {
    const FrictionSolution found = solve_friction(problem, {.tolerance = 1e-30, .maximum_factorisations = 5000});
    CHECK((found.status == FrictionStatus::stalled || found.state.residual == 0));
    CHECK(found.state.residual < 1e-14);
  }
  SUBCASE("stopped by the observer, which saw every check") {
    std::vector<Index> seen;
    const FrictionSolverOptions options{.algorithm = FrictionAlgorithm::nlgs, .tolerance = 1e-15, .check_every = 2};
    const FrictionSolution found = solve_friction(problem, options, {}, [&](const FrictionSolution& check) {
      seen.push_back(check.sweeps);
      return check.sweeps < 4;
    });
    CHECK(found.status == FrictionStatus::stopped);
    CHECK(seen == std::vector<Index>{0, 2, 4});
  }
  SUBCASE("diverged: W not positive definite across contacts") {
    const LocalFrictionProblem wild{sparse(Matrix{{1, 0, -3, 0}, {0, 1, 0, 0}, {-3, 0, 1, 0}, {0, 0, 0, 1}}),
                                    Vector{{-1, 0, -1, 0}}, Vector::Zero(2)};
    CHECK(solve_friction(wild).status == FrictionStatus::diverged);
    CHECK(solve_friction(wild, {.algorithm = FrictionAlgorithm::nlgs}).status == FrictionStatus::diverged);
  }
  CHECK(solve_friction(problem, {}, Vector::Constant(40, not_a_number)).status == FrictionStatus::not_finite);
  CHECK(solve_friction({SparseMatrix(0, 0), Vector(0), Vector(0)}).status == FrictionStatus::converged);  // no contact
  CHECK_THROWS_AS(solve_friction(problem, {}, Vector::Zero(3)), Error);
  CHECK_THROWS_AS(solve_friction(problem, {.relaxation = 2.0}), Error);
  CHECK_THROWS_AS(solve_friction(problem, {.tolerance = 0.0}), Error);
}
