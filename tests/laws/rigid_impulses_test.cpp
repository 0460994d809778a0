// SPDX-License-Identifier: GPL-3.0-or-later
// Impulses of networks of thousands of contacts: minutes where the sanitizers watch, so not among the unit tests.
#include "../support/dense.hpp"
#include "../support/problems.hpp"
#include "linalg/random.hpp"
#include "linalg/range_projector.hpp"
#include "mechanics/active_set.hpp"
#include "mechanics/gauss_seidel.hpp"
#include <nscdd/mechanics/law.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("rigid impulses: more than 1 000 contacts, masses over eight decades, least norm all the same") {
  Case large;
  Packing packing = generate(HexagonalLattice{.columns = 22, .rows = 18});
  RandomStream random(3);
  for (Index i = 0; i < packing.size(); ++i) packing.mass.push_back(std::pow(10.0, 8 * random.uniform() - 4));
  large.spec.packing = PackingFile{"unequal masses"};
  large.packing = packing;
  large.spec.prescribed = {{200, {-1.0, 0.3}}};
  const Model model = build(large);
  REQUIRE(model.problem.contacts() > 1000);
  const RigidImpulses rigid = rigid_impulses(model.problem);
  CHECK_FALSE(rigid.unique);
  CHECK(rigid.residual < 1e-9);
  // least norm: no part of r is a self-stress, that is r lies in the range of H^T
  const Dense transposed = Dense(model.problem.h).transpose();
  const Vector velocity = least_norm_solution(transposed, rigid.impulses);
  CHECK((transposed * velocity - rigid.impulses).norm() < 1e-8 * rigid.impulses.norm());
}

TEST_CASE("rigid impulses: the iterative solution tells how far it got (more than 4 000 contacts)") {
  const Model model = build(strip(2010));
  REQUIRE(model.problem.contacts() > 4000);
  const RigidImpulses rigid = rigid_impulses(model.problem);
  CHECK(rigid.unique);
  CHECK(rigid.residual < 1e-8);
}

TEST_CASE("rigid impulses: a lattice of more than 4 000 contacts, no part of them a self-stress, some exactly 0") {
  Case lattice;
  lattice.spec.packing = Generator{HexagonalLattice{.columns = 40, .rows = 37}};
  lattice.spec.masses.model = MassModel::unit;
  lattice.spec.loads.compression = {1.0, 0.0};
  const Model model = build(lattice);
  REQUIRE(model.problem.contacts() > 4000);
  const RigidImpulses rigid = rigid_impulses(model.problem);
  CHECK_FALSE(rigid.unique);
  CHECK(rigid.residual < 1e-10);
  const double largest = rigid.impulses.cwiseAbs().maxCoeff();
  CHECK((RangeProjector(model.problem.h.transpose()).apply(rigid.impulses) - rigid.impulses).lpNorm<Eigen::Infinity>() <
        1e-9 * largest);
  // Mirrored in a horizontal line, the contacts in it are pressed as much from above as from below; what is
  // left of an impulse that is 0 must stay far below 1e-10, from which on it counts as pressed.
  Index none = 0;
  for (Index c = 0; c < model.problem.contacts(); ++c) {
    const double size = std::abs(rigid.impulses[c]) / largest;
    none += size < 1e-8;
    CHECK((size < 3e-11 || size > 1e-8));
  }
  CHECK(none > 0);
}
