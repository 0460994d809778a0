// SPDX-License-Identifier: GPL-3.0-or-later
// Verdicts on contact problems: closed forms, problems made with or without a solution, and the proofs by themselves.
#include "../support/fclib_files.hpp"
#include "../support/sanitized.hpp"
#include "../support/thorough.hpp"
#include "linalg/random.hpp"
#include <nscdd/contact_solvers/verdict.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr Index fixed_wall = -1;

// A contact of two disks, or of a disk and a wall that moves away at `opening`. Its normal points from b to a.
struct Meeting {
  Index a, b;
  double x, y, opening = 0;
};

// Disks of mass 1 kg and radius 0.5 m, pulled down at 0.05 m/s.
LocalFrictionProblem pressed_disks(Index disks, const std::vector<Meeting>& meetings, double friction) {
  SparseMatrix mass(3 * disks, 3 * disks), h(3 * disks, 2 * count(meetings));
  GlobalFrictionProblem problem;
  problem.f = Vector::Zero(3 * disks);
  problem.w = Vector::Zero(2 * count(meetings));
  for (Index i = 0; i < disks; ++i) {
    for (const Index k : {0, 1, 2}) mass.insert(3 * i + k, 3 * i + k) = k == 2 ? 0.125 : 1;
    problem.f[3 * i + 1] = -0.05;
  }
  for (Index c = 0; c < count(meetings); ++c) {
    const Meeting& meeting = meetings[at(c)];
    for (const auto& [body, sign] : {std::pair(meeting.a, 1.0), std::pair(meeting.b, -1.0)}) {
      if (body == fixed_wall) continue;
      const double columns[2][3] = {{sign * meeting.x, sign * meeting.y, 0},
                                    {-sign * meeting.y, sign * meeting.x, -0.5}};
      for (const Index j : {0, 1})
        for (const Index k : {0, 1, 2}) h.insert(3 * body + k, 2 * c + j) = columns[j][k];
    }
    problem.w[2 * c] = meeting.opening;
  }
  problem.mass = mass;
  problem.h = h;
  problem.friction = Vector::Constant(count(meetings), friction);
  return reduce(problem);
}

// Disks in a row between two walls; the right one moves away at `opening`.
std::vector<Meeting> row_of(Index disks, double opening, Index first = 0) {
  std::vector<Meeting> meetings{{first, fixed_wall, 1, 0}};
  for (Index i = 1; i < disks; ++i) meetings.push_back({first + i, first + i - 1, 1, 0});
  meetings.push_back({first + disks - 1, fixed_wall, -1, 0, opening});
  return meetings;
}

LocalFrictionProblem without_bodies(LocalFrictionProblem problem) {
  problem.mass = {};
  problem.h = {};
  return problem;
}

// The verdicts with M and H, and with W only.
std::vector<Verdict> both(const LocalFrictionProblem& problem) {
  return {verdict_of(problem), verdict_of(without_bodies(problem))};
}

// A problem with H of random columns and M = I.
struct RandomBodies {
  Matrix h;
  Vector q, friction;
  Index dimension;

  LocalFrictionProblem problem() const {
    GlobalFrictionProblem made;
    made.mass.resize(h.rows(), h.rows());
    made.mass.setIdentity();
    made.h = h.sparseView();
    made.f = Vector::Zero(h.rows());
    made.w = q;
    made.friction = friction;
    made.dimension = dimension;
    return reduce(made);
  }
};
RandomBodies random_bodies(RandomStream& random) {
  const Index dimension = 2 + random.below(2), contacts = 3 + random.below(28);
  const Index rows = dimension + 1 + random.below(dimension * contacts);
  RandomBodies made{Matrix::Zero(rows, dimension * contacts), {}, Vector::Zero(contacts), dimension};
  for (Index k = 0; k < made.h.cols(); ++k) {
    made.h(k % rows, k) = random.normal();
    for (Index entry = 1; entry < 4; ++entry) made.h(random.below(rows), k) = random.normal();
  }
  made.q = random.normal_vector(made.h.cols());
  for (double& mu : made.friction) mu = random.uniform() < 0.2 ? 0 : random.uniform();
  return made;
}

const Index random_problems = sanitized ? 50 : thorough() ? 10'000 : 2000;

}  // namespace

TEST_CASE("walls that close on a row of disks: impossible, with the row as its chain") {
  for (Index disks = 1; disks <= (sanitized ? 12 : 50); ++disks)
    for (const Verdict& verdict : both(pressed_disks(disks, row_of(disks, -0.1), 0.3))) {
      CAPTURE(disks);
      CHECK(verdict.kind == VerdictKind::impossible);
      REQUIRE(count(verdict.chain) == disks + 1);
      for (Index c = 0; c <= disks; ++c) CHECK(verdict.chain[at(c)] == c);
      CHECK((verdict.stress - Vector::Ones(disks + 1)).norm() < 1e-12);
      CHECK(verdict.closing_speed == doctest::Approx(0.1).epsilon(1e-12));
      CHECK(verdict.proven_speed > 1e10);
      CHECK(verdict.normal_margin == doctest::Approx(-0.1 / static_cast<double>(disks + 1)).epsilon(1e-5));
      CHECK(verdict.factorisations <= 30);
    }
}

TEST_CASE("a plane problem in space has the same verdict; one that is stopped is that of what was found") {
  for (const double opening : {-0.1, 0.1}) {
    const LocalFrictionProblem plane = pressed_disks(5, row_of(5, opening), 0.3);
    const Verdict expected = verdict_of(plane), verdict = verdict_of(in_space(plane));
    CHECK(verdict.kind == expected.kind);
    CHECK(verdict.margin == doctest::Approx(expected.margin).epsilon(1e-5));
    CHECK(verdict.chain == expected.chain);
    const Verdict stopped = verdict_of(plane, [](Index, Index) { return false; });
    CHECK(stopped.kind != (opening > 0 ? VerdictKind::impossible : VerdictKind::exists));
    CHECK(stopped.factorisations <= 3);
    CHECK(stopped.margin <= opening / 6 + 1e-12);
  }
}

TEST_CASE("walls that move apart: the margin is their share of the opening") {
  for (const Index disks : {1, 2, 7, 50})
    for (const Verdict& verdict : both(pressed_disks(disks, row_of(disks, 0.1), 0.3))) {
      CHECK(verdict.kind == VerdictKind::exists);
      CHECK(verdict.margin == doctest::Approx(0.1 / static_cast<double>(disks + 1)).epsilon(1e-5));
      CHECK(verdict.chain.empty());
      CHECK(std::isnan(verdict.normal_margin));
    }
}

TEST_CASE("an arch under a ceiling that comes down: its self-stress is that of statics") {
  for (const double angle : {0.2, 0.5, 0.9}) {
    const double x = std::cos(angle), y = std::sin(angle);
    const std::vector<Meeting> meetings{{0, fixed_wall, 1, 0},  {0, fixed_wall, 0, 1},        {1, 0, x, y},
                                        {2, 1, x, -y},          {1, fixed_wall, 0, -1, -0.1}, {2, fixed_wall, 0, 1},
                                        {2, fixed_wall, -1, 0}, {0, fixed_wall, 0, 1}};
    for (const Verdict& verdict : both(pressed_disks(3, meetings, 0.3))) {
      CHECK(verdict.kind == VerdictKind::impossible);
      const double largest = std::max(1.0, 2 * y);
      // One of the two equal contacts with the floor carries.
      REQUIRE(verdict.chain.size() == 7);
      CHECK(verdict.stress[0] == doctest::Approx(x / largest));
      CHECK(verdict.closing_speed == doctest::Approx(0.2 * y / largest));
    }
  }
}

TEST_CASE("of equal rows between the same walls one is the chain") {
  std::vector<Meeting> meetings;
  for (Index row = 0; row < 4; ++row)
    for (const Meeting& meeting : row_of(3, -0.1, 3 * row)) meetings.push_back(meeting);
  for (const Verdict& verdict : both(pressed_disks(12, meetings, 0.3))) {
    CHECK(verdict.kind == VerdictKind::impossible);
    REQUIRE(verdict.chain.size() == 4);
    CHECK(verdict.chain[0] % 4 == 0);
    CHECK(verdict.chain[3] == verdict.chain[0] + 3);
    CHECK(verdict.closing_speed == doctest::Approx(0.1));
  }
}

TEST_CASE("a disk in a wedge under a lid that rises: the margin in closed form, and friction that jams") {
  constexpr double rise = 0.1;
  for (const double angle : {0.1, 0.4, 0.7, 1.2})
    for (const double friction : {0.0, 0.3, 0.6}) {
      INFO("angle = ", angle, ", friction = ", friction);
      const double x = std::cos(angle), y = std::sin(angle), share = y - friction * x;
      const LocalFrictionProblem problem =
          pressed_disks(1, {{0, fixed_wall, x, y}, {0, fixed_wall, -x, y}, {0, fixed_wall, 0, -1, rise}}, friction);
      for (const Verdict& verdict : both(problem)) {
        CHECK(verdict.kind == (share > 0 ? VerdictKind::exists : VerdictKind::undecided));
        if (share > 0) {
          CHECK(verdict.margin == doctest::Approx(rise * share / (1 + share)).epsilon(1e-5));
        } else {
          CHECK(verdict.margin <= 0);
          CHECK(verdict.margin > -1e-7);
          CHECK(verdict.normal_margin == doctest::Approx(rise * y / (1 + y)).epsilon(1e-5));
        }
      }
    }
}

TEST_CASE("closing walls that are not quite parallel: a disk escapes, or would have to be faster than any") {
  for (const double angle : {1e-2, 1e-4, 1e-10, 1e-13}) {
    CAPTURE(angle);
    const Verdict verdict = verdict_of(
        pressed_disks(1, {{0, fixed_wall, 1, 0}, {0, fixed_wall, -std::cos(angle), std::sin(angle), -0.1}}, 0));
    CHECK(verdict.kind == (angle > 1e-7 ? VerdictKind::exists : VerdictKind::impossible));
    if (angle > 1e-7) continue;
    CHECK(verdict.proven_speed <= 0.1001 / angle);
    CHECK(verdict.proven_speed > 0.02 / angle);
  }
}

TEST_CASE("a column under a piston has a solution, whatever presses") {
  std::vector<Meeting> meetings{{0, fixed_wall, 0, 1}};
  for (Index i = 1; i < 30; ++i) meetings.push_back({i, i - 1, 0, 1});
  LocalFrictionProblem problem = pressed_disks(30, meetings, 0.3);
  problem.q[2 * 29] = -50;
  for (const Verdict& verdict : both(problem)) CHECK(verdict.kind == VerdictKind::exists);
  CHECK(verdict_of(pressed_disks(1, {}, 0.3)).kind == VerdictKind::exists);
}

TEST_CASE("problems made with velocities of a margin have a solution, with that margin at least") {
  RandomStream random(1);
  Index undecided = 0, factorisations = 0;
  for (Index k = 0; k < random_problems; ++k) {
    CAPTURE(k);
    RandomBodies made = random_bodies(random);
    const double wanted = std::pow(10.0, -3 * random.uniform());
    Vector u = random.normal_vector(made.q.size());
    for (Index c = 0; c < made.friction.size(); ++c) {
      const Index n = made.dimension * c;
      u[n] = made.friction[c] * u.segment(n + 1, made.dimension - 1).norm() + wanted * (1 + random.uniform());
    }
    made.q = u - made.h.transpose() * random.normal_vector(made.h.rows());
    const LocalFrictionProblem problem = made.problem();
    const Verdict verdict = verdict_of(k % 2 == 0 ? problem : without_bodies(problem));
    REQUIRE(verdict.kind != VerdictKind::impossible);
    undecided += verdict.kind == VerdictKind::undecided;
    CHECK(verdict.margin > 0.99 * std::min(wanted, made.q.cwiseAbs().maxCoeff()));
    factorisations += verdict.factorisations;
  }
  CHECK(undecided <= random_problems / 1000);
  CHECK(factorisations <= 12 * random_problems);  // 9 each when written
}

TEST_CASE("problems made with a self-stress that supports work against have no solution") {
  RandomStream random(2);
  Index undecided = 0, factorisations = 0;
  for (Index k = 0; k < random_problems; ++k) {
    CAPTURE(k);
    RandomBodies made = random_bodies(random);
    const Index d = made.dimension, carrying = 2 + random.below(made.friction.size() - 1);
    Vector r = Vector::Zero(made.q.size());
    for (Index c = 0; c < carrying; ++c) r[d * c] = 0.1 + random.uniform();
    made.h.col(0) -= made.h * r / r[0];
    made.q[0] -= (made.q.dot(r) + std::pow(10.0, -3 * random.uniform())) / r[0];
    const LocalFrictionProblem problem = made.problem();
    const Verdict verdict = verdict_of(k % 2 == 0 ? problem : without_bodies(problem));
    REQUIRE(verdict.kind != VerdictKind::exists);
    factorisations += verdict.factorisations;
    if (verdict.kind == VerdictKind::undecided) {
      ++undecided;
      continue;
    }
    Vector found = Vector::Zero(made.q.size());
    for (Index i = 0; i < count(verdict.chain); ++i) found[d * verdict.chain[at(i)]] = verdict.stress[i];
    CHECK((made.h * found).norm() < 1e-6 * found.norm() * made.h.norm());
    CHECK(made.q.dot(found) == doctest::Approx(-verdict.closing_speed));
    CHECK(verdict.closing_speed > 0);
    CHECK(found.minCoeff() >= 0);
    CHECK(found.maxCoeff() == 1);
    CHECK(count(verdict.chain) <= made.h.rows() + 1);
  }
  CHECK(undecided <= random_problems / 100);      // 8 of 10 000 when written
  CHECK(factorisations <= 35 * random_problems);  // 26 each when written
}

TEST_CASE("proofs are below the numbers in more digits, by little") {
  RandomStream random(3);
  for (Index k = 0; k < 300; ++k) {
    CAPTURE(k);
    const RandomBodies made = random_bodies(random);
    const LocalFrictionProblem problem = made.problem();
    const Index d = made.dimension, contacts = made.friction.size();
    const Vector v = random.normal_vector(made.h.rows());
    const auto more = [](double x) { return static_cast<long double>(x); };
    long double margin = INFINITY;
    for (Index c = 0; c < contacts; ++c) {
      std::array<long double, 3> u{};
      for (Index j = 0; j < d; ++j) {
        u[at(j)] = more(made.q[d * c + j]);
        for (Index i = 0; i < v.size(); ++i) u[at(j)] += more(made.h(i, d * c + j)) * more(v[i]);
      }
      margin = std::min(margin, u[0] - more(made.friction[c]) * std::hypot(u[1], u[2]));
    }
    const double proven = proven_margin(problem, problem.friction, v);
    CHECK(more(proven) <= margin);
    CHECK(more(proven) >= margin - 1e-13L);

    const std::vector<Index> chain{0, contacts - 1};
    const Vector stress = (Vector(2) << 1, random.uniform()).finished();
    long double sum = 0, power = 0;
    for (Index i = 0; i < v.size(); ++i)
      sum += std::abs(more(made.h(i, 0)) + more(made.h(i, d * chain[1])) * more(stress[1]));
    power = more(made.q[0]) + more(made.q[d * chain[1]]) * more(stress[1]);
    const double speed = proven_speed(problem, chain, stress);
    if (power < -1e-10L) {
      CHECK(more(speed) <= -power / sum);
      CHECK(more(speed) >= -power / sum * (1 - 1e-5L));
    } else {
      CHECK(speed < 1e-8);
    }
    CHECK(proven_speed(problem, chain, -stress) == 0);
  }
}

TEST_CASE("a solution refutes a self-stress of the columns of a W that is not symmetric") {
  // W of a file may be asymmetric by its digits. r = (2000, 1000, 2001, 0) is a solution, u = (0, -500, 0, 0).
  LocalFrictionProblem problem;
  problem.w =
      SparseMatrix((Matrix(4, 4) << 1, 0.002, -1, 0, 0, 1, 0, 0, -1, 0, 1, 0, 0, 0, 0, 1).finished().sparseView());
  problem.q = Vector{{-1, -1500, -1, 0}};
  problem.friction = Vector::Constant(2, 0.5);
  check(problem, "problem");
  CHECK(verdict_of(problem).kind != VerdictKind::impossible);
  CHECK(proven_speed(problem, {0, 1}, Vector::Ones(2)) < 1e4);
  Vector infinite = Vector::Ones(2);
  infinite[0] = infinity;
  CHECK(proven_speed(problem, {0, 1}, infinite) == 0);
}
