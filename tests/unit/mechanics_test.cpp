// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/dense.hpp"
#include "../support/problems.hpp"
#include "linalg/random.hpp"
#include "mechanics/active_set.hpp"
#include "mechanics/gauss_seidel.hpp"
#include <nscdd/mechanics/law.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("H: relative normal velocity, balance of impulses, both entries kept where a component is 0") {
  const Packing packing{{0.0, 1.0}, {0.0, 0.0}, {0.5, 0.5}, {2.0, 3.0}};
  const ReferenceProblem problem = assemble(packing, detect_contacts(packing), {{1, {-1.0, 5.0}}});
  CHECK(problem.h.nonZeros() == 4);
  const Vector approach = (Vector(4) << 0, 0, -1, 0).finished();
  CHECK(Vector(problem.h.transpose() * approach)[0] == -1.0);  // approach: v < 0
  CHECK(Vector(problem.h * Vector::Ones(1)) == (Vector(4) << -1, 0, 1, 0).finished());
  CHECK(problem.inertia == (Vector(4) << 2, 2, 3, 3).finished());
  CHECK(problem.arriving_velocity == (Vector(4) << 0, 0, -1, 5).finished());
  CHECK(grains_of_contact(problem, 0) == std::vector<Index>{0, 1});
}

TEST_CASE("H: rigid motions cause no relative velocity") {
  const Model model = build(random_lattice(3, 5, 9, {2, 3}));
  Vector shift(model.problem.inertia.size());
  for (Index i = 0; i < model.problem.grains(); ++i) shift.segment(2 * i, 2) << 0.3, -2.0;
  CHECK((model.problem.h.transpose() * shift).norm() < 1e-12);
}

TEST_CASE("assembly refuses missing masses and grains that do not exist") {
  const Packing packing{{0.0, 1.0}, {0.0, 0.0}, {0.5, 0.5}, {}};
  CHECK_THROWS_AS(assemble(packing, detect_contacts(packing)), Error);
  const Packing weighed{{0.0, 1.0}, {0.0, 0.0}, {0.5, 0.5}, {1, 1}};
  CHECK_THROWS_AS(assemble(weighed, detect_contacts(weighed), {{2, {1, 0}}}), Error);
  CHECK_THROWS_AS(assemble(weighed, detect_contacts(weighed), {{0, {not_a_number, 0}}}), Error);
}

TEST_CASE("rigid impulses: two disks share their momentum") {
  const Packing packing{{0.0, 1.0}, {0.0, 0.0}, {0.5, 0.5}, {1.0, 3.0}};
  const ReferenceProblem problem = assemble(packing, detect_contacts(packing), {{1, {-1.0, 0.0}}});
  const RigidImpulses rigid = rigid_impulses(problem);
  CHECK(rigid.unique);
  CHECK(rigid.impulses[0] == doctest::Approx(0.75));  // reduced mass x velocity
  CHECK(rigid.residual < 1e-14);
  CHECK(active_contacts(problem, rigid) == std::vector<char>{1});
  const ReferenceProblem leaving = assemble(packing, detect_contacts(packing), {{1, {1.0, 0.0}}});
  CHECK(active_contacts(leaving, rigid_impulses(leaving)) == std::vector<char>{0});
}

TEST_CASE("rigid impulses of a hyperstatic network: the least-norm solution, said so") {
  const Model model = build(random_lattice(2, 8, 6, {1, 1}));
  const RigidImpulses rigid = rigid_impulses(model.problem);
  CHECK_FALSE(rigid.unique);
  CHECK(rigid.residual < 1e-10);
  const Dense h = model.problem.h;
  const Dense w = h.transpose() * diagonal(model.problem.inertia.cwiseInverse()) * h;
  const Vector expected = least_norm_solution(w, -h.transpose() * model.problem.arriving_velocity);
  CHECK((rigid.impulses - expected).norm() < 1e-9 * expected.norm());
}

TEST_CASE("the active set needs a prescribed velocity, which may load no contact") {
  Case one = strip(4);
  one.spec.prescribed.clear();
  const Model still = build(one);
  CHECK_THROWS_WITH_AS(active_contacts(still.problem, rigid_impulses(still.problem)),
                       doctest::Contains("expected a prescribed velocity"), Error);
  const Packing packing{{0.0, 1.0, 9.0}, {0.0, 0.0, 0.0}, {0.5, 0.5, 0.5}, {1, 1, 1}};
  const ReferenceProblem idle = assemble(packing, detect_contacts(packing), {{2, {1.0, 0.0}}});
  CHECK(active_contacts(idle, rigid_impulses(idle)) == std::vector<char>{0});
}

TEST_CASE("active contacts push, by more than rounding next to the largest impulse") {
  const Model model = build(strip(4));
  RigidImpulses rigid;
  rigid.impulses = (Vector(5) << 2.0, -3.0, 1e-12, 1e-9, 0.0).finished();
  CHECK(active_contacts(model.problem, rigid) == std::vector<char>{1, 0, 0, 1, 0});
}

TEST_CASE("Gauss-Seidel sweeps converge to the linear solution and keep velocities consistent") {
  const Model model = build(random_lattice(1, 6, 5, {1, 1}));
  const Dense h = model.problem.h;
  const ContactSystem contacts = prepare_contacts(model.problem.inertia, model.problem.h);
  const LinearViscous law{0.5};
  Vector r = Vector::Zero(h.cols()), v = model.problem.arriving_velocity;
  for (int sweep = 0; sweep < 400; ++sweep) gauss_seidel_sweep(contacts, law, r, v);
  const Vector consistent =
      model.problem.arriving_velocity + model.problem.inertia.cwiseInverse().asDiagonal() * (h * r);
  CHECK((v - consistent).norm() < 1e-12);
  CHECK((h.transpose() * v + law.epsilon * r).norm() < 1e-10);  // the law, contact by contact
}

TEST_CASE("linear law: v = free + W r and r = -v/epsilon at once; rigid: v = 0") {
  const LinearViscous law{0.3};
  const double r = law.impulse(-2.0, 1.5), v = -2.0 + 1.5 * r;
  CHECK(r == doctest::Approx(-v / 0.3));
  CHECK(-2.0 + 1.5 * LinearViscous{0}.impulse(-2.0, 1.5) == doctest::Approx(0.0));
}
