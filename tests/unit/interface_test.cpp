// SPDX-License-Identifier: GPL-3.0-or-later
// The interface alone: copies, rows, neighbours, and what it exchanges, against A_E as matrices.
#include "../support/problems.hpp"
#include "linalg/random.hpp"
#include "linalg/threads.hpp"
#include <nscdd/ddm/interface_operator.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Grain 2 has three copies, grains 1 and 3 two, grain 4 two that are not glued; grain 5 touches nothing.
struct Example {
  std::vector<std::vector<Index>> held{{0, 1, 2}, {4, 2, 3}, {3, 2, 1, 4}};
  std::vector<char> tied{1, 1, 1, 1, 0, 1};

  Interface make(Index d, GluingShape shape = GluingShape::chain) const {
    return {d, 6, {held[0], held[1], held[2]}, tied, shape};
  }
};

std::vector<Vector> random_copies(const Interface& interface, const std::vector<std::vector<Index>>& held) {
  RandomStream stream(7);
  std::vector<Vector> v;
  for (const auto& grains : held) v.push_back(stream.normal_vector(interface.dofs_per_grain() * count(grains)));
  return v;
}

}  // namespace

TEST_CASE("interface: copies, multiplicity, rows in ascending order, neighbours") {
  const Example example;
  const Interface chain = example.make(3);
  CHECK(chain.grains() == 6);
  CHECK(chain.size() == 12);
  const Index expected[] = {1, 2, 3, 2, 2, 0};
  for (Index g = 0; g < 6; ++g) CHECK(chain.multiplicity(g) == expected[g]);
  CHECK(chain.copies(2)[1].subdomain == 1);
  CHECK(chain.copies(2)[1].grain == 1);
  CHECK(chain.copies(5).empty());
  REQUIRE(chain.gluing().size() == 4);
  CHECK(chain.gluing()[1].grain == 2);
  CHECK(chain.gluing()[2].first.subdomain == 1);
  CHECK(chain.gluing()[2].second.subdomain == 2);
  const Interface star = example.make(3, GluingShape::star);
  CHECK(star.gluing()[2].first.subdomain == 0);
  CHECK(chain.same_rows(chain));
  CHECK_FALSE(chain.same_rows(star));
  CHECK_FALSE(chain.same_rows(example.make(2)));
}

TEST_CASE("interface: rows of one grain are not the same where another subdomain has its second copy") {
  const std::vector<Index> here{0}, nowhere;
  const Interface second(2, 1, {here, here, nowhere}, {}), third(2, 1, {here, nowhere, here}, {});
  CHECK(second.size() == third.size());
  CHECK_FALSE(second.same_rows(third));
}

TEST_CASE("interface: exchange and distribute are A_E and A_E^T; copies apart have the jumps asked for") {
  const Example example;
  for (const Index d : {2, 3, 6})
    for (const GluingShape shape : {GluingShape::chain, GluingShape::star}) {
      const Interface interface = example.make(d, shape);
      const std::vector<Vector> v = random_copies(interface, example.held);
      const Vector f = RandomStream(8).normal_vector(interface.size());
      Vector jumps = Vector::Zero(interface.size());
      double work = 0;
      for (Index e = 0; e < 3; ++e) {
        const SparseMatrix a = interface.matrix(e);
        jumps += a * v[at(e)];
        CHECK((interface.distribute(e, f) - a.transpose() * f).norm() < 1e-14);
        work += interface.distribute(e, f).dot(v[at(e)]);
      }
      CHECK((interface.exchange(v) - jumps).norm() < 1e-14);
      CHECK(f.dot(jumps) == doctest::Approx(work));
      CHECK((interface.exchange(interface.copies_apart(f)) - f).norm() < 1e-13);
      std::vector<Vector> impulses;
      for (Index e = 0; e < 3; ++e) impulses.push_back(interface.distribute(e, f));
      CHECK((interface.collect(impulses) - f).norm() < 1e-13);
    }
}

TEST_CASE("interface: thousands of rows are exchanged and solved in blocks, with the bits of one thread") {
  // Grains of two to five copies: no block may cut one.
  const Index grains = 1500;
  std::vector<std::vector<Index>> lists(5);
  for (Index grain = 0; grain < grains; ++grain)
    for (Index e = 0; e < 2 + grain % 4; ++e) lists[at((grain + e) % 5)].push_back(grain);
  std::vector<std::span<const Index>> held(lists.begin(), lists.end());
  for (const GluingShape shape : {GluingShape::chain, GluingShape::star}) {
    const Interface interface(3, grains, held, {}, shape);
    REQUIRE(interface.size() / 3 > 3000);
    const std::vector<Vector> v = random_copies(interface, lists);
    Vector jumps = Vector::Zero(interface.size());
    for (Index e = 0; e < 5; ++e) jumps += interface.matrix(e) * v[at(e)];
    const auto inertia = [](Index row, Index k) { return 1 + 0.5 * std::cos(static_cast<double>(row + k)); };
    const auto inertia_of_grain = [&](Index row, Index k) {
      while (row > 0 && interface.gluing()[at(row - 1)].grain == interface.gluing()[at(row)].grain) --row;
      return inertia(row, k);
    };
    Vector solved;
    for (const Index threads : {1, 2, 4}) {
      CAPTURE(threads);
      const ThreadLimit limit(threads);
      CHECK(interface.exchange(v) == jumps);
      const Vector f = interface.solve_generic(inertia_of_grain, jumps);
      if (threads == 1) solved = f;
      CHECK(f == solved);
    }
    // X_inf F = jumps
    Vector again = Vector::Zero(interface.size());
    for (Index e = 0; e < 5; ++e) {
      const Vector impulses = interface.distribute(e, solved);
      Vector velocities = Vector::Zero(impulses.size());
      for (const Tie& tie : interface.ties(e))
        for (Index k = 0; k < 3; ++k)
          velocities[3 * tie.grain + k] = impulses[3 * tie.grain + k] / inertia_of_grain(tie.row, k);
      again += interface.matrix(e) * velocities;
    }
    CHECK((again - jumps).norm() < 1e-12 * jumps.norm());
  }
}

TEST_CASE("interface: X_infinity^-1 in closed form, for chains and stars, unequal masses, grains of many copies") {
  const Model model = build(random_lattice(3, 8, 7, {3, 3}));
  REQUIRE(cross_points(model.parts) > 0);
  for (const GluingShape shape : {GluingShape::chain, GluingShape::star}) {
    const Decomposition parts = decompose(model.problem, model.partition, shape);
    const InterfaceOperator x = InterfaceFamily(parts).at(infinity);
    const Vector f = RandomStream(9).normal_vector(x.rows());
    CHECK((x.solve(x.apply(f)) - f).norm() < 1e-13 * f.norm());
    CHECK((x.apply(x.solve(f)) - f).norm() < 1e-13 * f.norm());
  }
}

TEST_CASE("interface: X_eta^-1 on the interface alone is that by the undivided packing") {
  const Model model = build(random_lattice(3, 8, 7, {3, 3}));
  for (const GluingShape shape : {GluingShape::chain, GluingShape::star}) {
    const Decomposition parts = decompose(model.problem, model.partition, shape);
    const InterfaceFamily assembled(parts), alone(parts, InterfaceFamily::default_dense_limit, multifrontal());
    for (const double eta : {1e-4, 0.3, 1e3}) {
      CAPTURE(eta);
      const InterfaceOperator x = alone.at(eta);
      const Vector f = RandomStream(5).normal_vector(x.rows()), expected = assembled.at(eta).solve(f);
      CHECK((x.solve(f) - expected).norm() < 1e-9 * expected.norm());
      CHECK((x.solve(x.apply(f)) - f).norm() < 1e-9 * f.norm());
      CHECK((expected - x.solve_generic(f)).norm() > 1e-6 * expected.norm());  // another matrix than X
    }
    CHECK_THROWS_WITH_AS(alone.at(0).solve(Vector::Ones(parts.interface_size())), doctest::Contains("has no inverse"),
                         Error);
  }
}
