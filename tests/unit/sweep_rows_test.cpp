// SPDX-License-Identifier: GPL-3.0-or-later
// Orders of the contacts in nonlinear Gauss-Seidel sweeps over W.
#include "contact_solvers/sweep_rows.hpp"

#include "../support/fclib_files.hpp"
#include "../support/literal_sweeps.hpp"
#include "../support/sanitized.hpp"
#include "contact_solvers/contact_turns.hpp"
#include "linalg/random.hpp"
#include "linalg/threads.hpp"
#include "mechanics/contact_law.hpp"

#include <doctest/doctest.h>

#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// 2 300 contacts of 1 000 grains, of which a contact is coupled with some eight others.
LocalFrictionProblem many_contacts() { return reduce(random_bodies_problem(7, 1000, 2300)); }

Vector swept(const LocalFrictionProblem& problem, SweepOrder order, Index sweeps, Index seed = 1,
             const Vector& guess = {}) {
  return solve_friction(problem,
                        {.algorithm = FrictionAlgorithm::nlgs,
                         .tolerance = 1e-300,
                         .maximum_sweeps = sweeps,
                         .order = order,
                         .seed = seed},
                        guess)
      .impulses;
}

bool are_coupled(const LocalFrictionProblem& problem, Index a, Index b) {
  for (const Index i : {2 * a, 2 * a + 1})
    for (const Index j : {2 * b, 2 * b + 1})
      if (problem.w.coeff(i, j) != 0) return true;
  return false;
}

}  // namespace

TEST_CASE("every order takes each contact once, and keeps its data") {
  const LocalFrictionProblem problem = many_contacts();
  const Vector values = Vector::LinSpaced(4600, 1, 4600);
  for (const std::string& name : all_names<SweepOrder>()) {
    CAPTURE(name);
    const SweepRows<2> rows(problem, Choice<SweepOrder>(name), 3);
    CHECK(std::set<Index>(rows.contact.begin(), rows.contact.end()).size() == 2300);
    CHECK(rows.size() == 2300);
    CHECK(rows.by_contact(rows.in_order(values)) == values);
    for (Index place = 0; place < rows.size(); place += 97) {
      const Index c = rows.contact[at(place)];
      CHECK(rows.q[2 * place + 1] == problem.q[2 * c + 1]);
      CHECK(rows.friction[place] == problem.friction[c]);
      CHECK(rows.diagonal[at(place)].nn == problem.w.coeff(2 * c, 2 * c));
    }
  }
}

TEST_CASE("products in blocks are those of the matrix, in any order of contacts and on any number of threads") {
  constexpr Index contacts = 10'000;  // enough for threads
  RandomStream random(5);
  std::vector<Eigen::Triplet<double>> entries;  // blocks with one to four entries, and rows without any
  for (Index k = 0; k < 6 * contacts; ++k)
    entries.emplace_back(random.below(2 * contacts - 100), random.below(2 * contacts), random.normal());
  SparseMatrix w(2 * contacts, 2 * contacts);
  w.setFromTriplets(entries.begin(), entries.end());
  const Vector x = random.normal_vector(2 * contacts), expected = w * x;
  const ContactBlocks<2> blocks(w);
  CHECK((blocks * x - expected).norm() <= 1e-14 * expected.norm());
  CHECK(blocks.row(contacts - 1).empty());

  std::vector<Index> order(contacts);
  for (Index place = 0; place < contacts; ++place) order[at(place)] = (7 * place + 3) % contacts;
  Vector there(2 * contacts), wanted(2 * contacts);
  for (Index place = 0; place < contacts; ++place) {
    there.segment<2>(2 * place) = x.segment<2>(2 * order[at(place)]);
    wanted.segment<2>(2 * place) = expected.segment<2>(2 * order[at(place)]);
  }
  const ContactBlocks<2> ordered(w, order);
  CHECK((ordered * there - wanted).norm() <= 1e-14 * expected.norm());
  Vector alone, together;
  {
    const ThreadLimit limit(1);
    alone = ordered * there;
  }
  {
    const ThreadLimit limit(4);
    together = ordered * there;
  }
  CHECK(alone == together);
}

TEST_CASE("a symmetric sweep goes to and fro, a reverse one is a natural one of the problem turned round") {
  const LocalFrictionProblem problem = many_contacts();
  const Vector forth = swept(problem, SweepOrder::natural, 1);
  const Vector back = swept(problem, SweepOrder::reverse, 1, 1, forth);
  CHECK(swept(problem, SweepOrder::symmetric, 1) == forth);
  const Vector both = swept(problem, SweepOrder::symmetric, 2);  // the others begin with velocities computed afresh
  CHECK((both - back).norm() < 1e-13 * back.norm());
  const Vector again = swept(problem, SweepOrder::natural, 1, 1, back);
  CHECK((swept(problem, SweepOrder::symmetric, 3) - again).norm() < 1e-13 * again.norm());
  CHECK(swept(problem, SweepOrder::natural, 2) != back);
}

TEST_CASE("random order: one permutation of its seed") {
  const LocalFrictionProblem problem = many_contacts();
  const Vector first = swept(problem, SweepOrder::random, 3, 1);
  CHECK(first == swept(problem, SweepOrder::random, 3, 1));
  CHECK(first != swept(problem, SweepOrder::random, 3, 2));
  const std::vector<Index> one = SweepRows<2>(problem, SweepOrder::random, 1).contact;
  Index ascents = 0;  // half of all in a permutation at random: 1150 +- 14
  for (std::size_t k = 1; k < one.size(); ++k) ascents += one[k] > one[k - 1];
  CHECK(ascents > 1050);
  CHECK(ascents < 1250);
  CHECK_THROWS_AS(swept(problem, SweepOrder::random, 1, -1), Error);
}

TEST_CASE("contacts of one colour are not coupled, and the number of threads changes no bit") {
  const LocalFrictionProblem problem = many_contacts();
  const SweepRows<2> rows(problem, SweepOrder::coloured, 1);
  REQUIRE(rows.first_of_colour.size() > 4);
  CHECK(rows.first_of_colour.size() < 30);
  CHECK(rows.first_of_colour.front() == 0);
  CHECK(rows.first_of_colour.back() == 2300);
  CHECK(rows.first_of_colour[1] > 300);  // more than one thread takes at a time
  const ContactBlocks<2> w(problem.w, rows.contact);
  Index wrong = 0, coupled = 0;
  for (std::size_t k = 0; k + 1 < rows.first_of_colour.size(); ++k)
    for (Index place = rows.first_of_colour[k]; place < rows.first_of_colour[k + 1]; ++place)
      for (const int other : w.row(place)) {
        if (other == place) continue;
        ++coupled;
        wrong += other >= rows.first_of_colour[k] && other < rows.first_of_colour[k + 1];
      }
  CHECK(wrong == 0);
  CHECK(coupled > 7000);
  Vector alone, together;
  {
    const ThreadLimit limit(1);
    alone = swept(problem, SweepOrder::coloured, 10);
  }
  {
    const ThreadLimit limit(4);
    together = swept(problem, SweepOrder::coloured, 10);
  }
  CHECK(alone == together);
}

TEST_CASE("a colour is kept where W is stored on one side of its diagonal only") {
  LocalFrictionProblem problem;  // contact 1 feels contact 0, which does not feel it
  problem.w = SparseMatrix((Matrix(4, 4) << 1, 0, 0, 0, 0, 1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1).finished().sparseView());
  problem.q = Vector::Constant(4, -1);
  problem.friction = Vector::Constant(2, 0.3);
  CHECK(SweepRows<2>(problem, SweepOrder::coloured, 1).first_of_colour == std::vector<Index>{0, 1, 2});
  problem.w = SparseMatrix(problem.w.transpose());
  CHECK(SweepRows<2>(problem, SweepOrder::coloured, 1).first_of_colour == std::vector<Index>{0, 1, 2});
}

TEST_CASE("interleaved: blocks of 256 contacts as numbered, coupled ones apart") {
  const LocalFrictionProblem problem = many_contacts();
  const std::vector<Index> order = SweepRows<2>(problem, SweepOrder::interleaved, 1).contact;
  const auto next_coupled = [&](const std::vector<Index>& contacts) {
    Index pairs = 0;
    for (std::size_t k = 1; k < contacts.size(); ++k) pairs += are_coupled(problem, contacts[k - 1], contacts[k]);
    return pairs;
  };
  Index elsewhere = 0;
  for (std::size_t place = 0; place < order.size(); ++place)
    elsewhere += order[place] / 256 != static_cast<Index>(place) / 256;
  CHECK(elsewhere == 0);
  CHECK(next_coupled(order) <= 9 * 12);  // where a colour ends and the next begins
}

namespace {

// On stored rows of W, and on the velocities of bodies if M and H are known.
template <int D>
void check_sweeps(LocalFrictionProblem problem) {
  RandomStream random(11);
  const Vector start = random.normal_vector(problem.size()).cwiseAbs();
  std::vector<Index> order = natural_order(problem.contacts());
  REQUIRE(BodyBlocks<D>::of(problem, {}).has_value());
  for (const bool bodies : {true, false}) {
    if (!bodies) problem.mass = problem.h = SparseMatrix();
    const SweepRows<D> rows(problem, SweepOrder::natural, 1);
    for (const auto& [omega, momentum] : {std::pair(1.0, 0.0), {0.7, 0.0}, {1.0, 0.8}, {1.0, 0.3}}) {
      const Vector expected = literal_sweeps<D>(problem, order, start, 4, omega, momentum);
      const Vector found = rows.swept(start, {.many = 4, .momentum = momentum}, omega);
      CHECK((found - expected).norm() < 1e-12 * expected.norm());
      CHECK((expected - start).norm() > 0.1 * start.norm());
    }
  }
  CHECK_FALSE(BodyBlocks<D>::of(problem, {}).has_value());
}

// A column of disks of 1 kg on a floor, each pressed down by 1 N s. Contact k is below disk k.
LocalFrictionProblem column_of_disks(Index disks) {
  SparseMatrix h(3 * disks, 2 * disks), mass(3 * disks, 3 * disks);
  GlobalFrictionProblem problem;
  problem.f = Vector::Zero(3 * disks);
  problem.w = Vector::Zero(2 * disks);
  problem.friction = Vector::Constant(disks, 0.3);
  for (Index k = 0; k < disks; ++k) {
    for (Index i = 0; i < 3; ++i) mass.coeffRef(3 * k + i, 3 * k + i) = i < 2 ? 1 : 0.5;
    problem.f[3 * k + 1] = -1;
    for (Index body = std::max<Index>(k - 1, 0); body <= k; ++body) {
      const double sign = body == k ? 1 : -1;
      h.coeffRef(3 * body + 1, 2 * k) = sign;
      h.coeffRef(3 * body, 2 * k + 1) = -sign;
      h.coeffRef(3 * body + 2, 2 * k + 1) = -1;
    }
  }
  problem.mass = mass;
  problem.h = h;
  return reduce(problem);
}

}  // namespace

TEST_CASE("sweeps on stored rows and on velocities of bodies are the literal ones, with momentum too") {
  check_sweeps<2>(reduce(random_bodies_problem(8, 30, 70)));
  check_sweeps<3>(reduce(random_spheres_problem(8, 20, 50)));
  // Normal impulses with a lever arm: blocks of W couple n and t.
  GlobalFrictionProblem boxes = random_bodies_problem(9, 30, 70);
  for (Index c = 0; c < 29; ++c) boxes.h.coeffRef(3 * c + 2, 2 * c) = 0.4;
  boxes.h.makeCompressed();
  check_sweeps<2>(reduce(boxes));
}

TEST_CASE("M and H of another form than two bodies per contact are left to stored rows") {
  LocalFrictionProblem problem = reduce(random_bodies_problem(8, 30, 70));
  const auto refused = [](LocalFrictionProblem other) {
    return !BodyBlocks<2>::of(other, natural_order(70)).has_value();
  };
  CHECK_FALSE(refused(problem));
  LocalFrictionProblem three = problem;
  three.h.coeffRef(60, 0) = 0.1;  // contact 0 joins bodies 0 and 1
  three.h.makeCompressed();
  CHECK(refused(three));
  LocalFrictionProblem coupled = problem;
  coupled.mass.coeffRef(0, 1) = coupled.mass.coeffRef(1, 0) = 0.1;
  coupled.mass.makeCompressed();
  CHECK(refused(coupled));
}

TEST_CASE("accelerated sweeps take a fraction of the sweeps on a slow problem" * doctest::skip(sanitized)) {
  // A column of disks on a floor: the slowest mode of sweeps needs some n^2 of them.
  const LocalFrictionProblem column = column_of_disks(60);
  const FrictionSolverOptions options{.algorithm = FrictionAlgorithm::nlgs};
  FrictionSolverOptions faster = options;
  faster.algorithm = FrictionAlgorithm::accelerated;
  const FrictionSolution plain = solve_friction(column, options), found = solve_friction(column, faster);
  REQUIRE(plain.status == FrictionStatus::converged);
  REQUIRE(found.status == FrictionStatus::converged);
  for (Index k = 0; k < 60; ++k)
    CHECK(found.impulses[2 * k] == doctest::Approx(60.0 - static_cast<double>(k)).epsilon(1e-4));
  CHECK(found.sweeps < 0.35 * static_cast<double>(plain.sweeps));
}

TEST_CASE("impulses of accelerated sweeps are judged after sweeps without momentum: they obey the cones" *
          doctest::skip(sanitized)) {  // minutes
  const LocalFrictionProblem problem = many_contacts();
  Index checks = 0, sliding = 0;
  solve_friction(problem, {.algorithm = FrictionAlgorithm::accelerated, .tolerance = 1e-14, .maximum_sweeps = 2000}, {},
                 [&](const FrictionSolution& check) {
                   for (Index c = 0; c < problem.contacts(); ++c) {
                     const LocalVector<2> r = component<2>(check.impulses, c);
                     CHECK(std::abs(r.t) <= problem.friction[c] * r.n * (1 + 1e-12));
                   }
                   sliding = check.state.slide;
                   return ++checks < 12;
                 });
  CHECK(checks > 4);
  CHECK(sliding > 100);
}

TEST_CASE("contacts of one body have different colours, also where W does not couple them") {
  // Point masses whose three rows are not one body: contacts c and c + half act on other rows of the same three.
  constexpr Index half = 3000;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index c = 0; c < half; ++c) {
    entries.emplace_back(3 * c, 2 * c, 1.0);
    entries.emplace_back(3 * c + 1, 2 * c + 1, 1.0);
    entries.emplace_back(3 * c + 2, 2 * (c + half), 1.0);
    entries.emplace_back(3 * ((c + 1) % half), 2 * (c + half) + 1, 0.5);
  }
  GlobalFrictionProblem global;
  global.h.resize(3 * half, 4 * half);
  global.h.setFromTriplets(entries.begin(), entries.end());
  global.mass.resize(3 * half, 3 * half);
  global.mass.setIdentity();
  global.f = RandomStream(5).normal_vector(3 * half);
  global.w = Vector::Zero(4 * half);
  global.friction = Vector::Constant(2 * half, 0.4);
  const LocalFrictionProblem problem = reduce(global);
  REQUIRE(BodyBlocks<2>::of(problem, natural_order(2 * half)).has_value());
  const SweepRows<2> rows(problem, SweepOrder::coloured, 1);
  std::set<std::pair<Index, Index>> met;  // colour and body
  for (std::size_t k = 0; k + 1 < rows.first_of_colour.size(); ++k)
    for (Index place = rows.first_of_colour[k]; place < rows.first_of_colour[k + 1]; ++place)
      for (const Index body : std::get<BodyBlocks<2>>(rows.w).bodies_of(place))
        CHECK(met.insert({static_cast<Index>(k), body}).second);
}

TEST_CASE("accelerated sweeps: the number of threads changes no bit") {
  const LocalFrictionProblem problem = reduce(random_bodies_problem(6, 4000, 9000));  // enough for threads
  const FrictionSolverOptions options{.algorithm = FrictionAlgorithm::accelerated,
                                      .maximum_sweeps = sanitized ? 10 : 60,
                                      .order = SweepOrder::coloured};
  Vector alone, together;
  {
    const ThreadLimit limit(1);
    alone = solve_friction(problem, options).impulses;
  }
  {
    const ThreadLimit limit(4);
    together = solve_friction(problem, options).impulses;
  }
  CHECK(alone.norm() > 0);
  CHECK(alone == together);
}
