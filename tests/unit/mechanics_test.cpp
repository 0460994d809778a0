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

TEST_CASE(
    "H in space: the normal on both spheres, rigid motions cause no relative velocity, six of them are independent") {
  const double s = std::sqrt(0.5);
  const Packing packing{{0, 0}, {0, s}, {0.5, 0.5}, {2, 3}, {0, s}};
  const ReferenceProblem two = assemble(packing, detect_contacts(packing), {{1, {-1, 5, 0.5}}});
  CHECK((two.dimension == 3 && two.dofs_per_grain == 3));
  CHECK(two.inertia == (Vector(6) << 2, 2, 2, 3, 3, 3).finished());
  CHECK(two.arriving_velocity == (Vector(6) << 0, 0, 0, -1, 5, 0.5).finished());
  CHECK((Vector(two.h * Vector::Ones(1)) - (Vector(6) << 0, -s, -s, 0, s, s).finished()).norm() < 1e-15);
  CHECK(two.h.nonZeros() == 6);
  CHECK(mean_normal_delassus(two) == doctest::Approx(1.0 / 2 + 1.0 / 3));

  for (const Case& one : spatial_problems()) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    Matrix motions(3 * model.grains(), 6);
    for (Index i = 0; i < model.grains(); ++i) {
      const auto [x, y, z] = model.packing.centre(i);
      motions.middleRows(3 * i, 3) << 1, 0, 0, 0, z, -y, 0, 1, 0, -z, 0, x, 0, 0, 1, y, -x, 0;
    }
    CHECK((model.problem.h.transpose() * motions).norm() < 1e-12 * motions.norm());
    CHECK(rank(Dense(motions)) == 6);
    CHECK(rank(Dense(model.problem.h)) <= 3 * model.grains() - 6);
  }
}

TEST_CASE("loads in space: a homogeneous deformation about the centre of mass, without momentum") {
  Case one = random_fcc(4, 4, 4, 4, GridPartitioner{{1, 1, 1}});
  one.spec.prescribed = {{2, {0.25, -0.5, 4}}};
  override_case(one.spec, "loads.compression", "2,3,-1");
  override_case(one.spec, "loads.shear", "0.5");
  const Model model = build(one);
  const Packing& p = model.packing;
  const Vector& v = model.problem.arriving_velocity;
  CHECK(v.segment(6, 3) == (Vector(3) << 0.25, -0.5, 4).finished());
  const Index last = p.size() - 1;  // of the highest layer
  const double x = p.x[at(last)] - p.x[4], y = p.y[at(last)] - p.y[4], z = p.z[at(last)] - p.z[4];
  REQUIRE(std::min({std::abs(x), std::abs(y), std::abs(z)}) > 0.1);
  const Vector between = v.segment(3 * last, 3) - v.segment(12, 3);
  CHECK((between - (Vector(3) << -2 * x + 0.5 * y, 0.5 * x - 3 * y, z).finished()).norm() < 1e-12);
  one.spec.prescribed.clear();
  const ReferenceProblem free = build(one).problem;
  const Vector momentum = free.inertia.cwiseProduct(free.arriving_velocity);
  for (Index k = 0; k < 3; ++k) {
    double sum = 0;
    for (Index i = 0; i < free.grains(); ++i) sum += momentum[3 * i + k];
    CHECK(std::abs(sum) < 1e-12 * momentum.norm());
  }
}

TEST_CASE("loads and velocities that do not fit the dimension are refused by key, expected and met") {
  const auto refused = [](Case one, const char* message) { CHECK_THROWS_WITH_AS(build(one), message, Error); };
  for (const Case& one : {strip(4), two_tetrahedra()}) {
    const bool plane = one.spec.name == "strip4";
    Case velocity = one, rates = one, fitting = one;
    velocity.spec.prescribed = {{0, {1, 0}}, {1, {1, 0}}};
    velocity.spec.prescribed[plane ? 1 : 0].velocity = {1, 0, 2};
    refused(velocity, plane ? "prescribed[1].velocity: expected two numbers for a packing in the plane, met [1, 0, 2]"
                            : "prescribed[1].velocity: expected three numbers for a packing in space, met [1, 0]");
    rates.spec.loads.compression = {1, 0.5};
    if (plane) rates.spec.loads.compression = {0, 0, 0.5};
    refused(rates, plane ? "loads.compression: expected two numbers for a packing in the plane, met [0, 0, 0.5]"
                         : "loads.compression: expected three numbers for a packing in space, met [1, 0.5]");
    fitting.spec.loads.shear = 2;  // no compression has no direction
    CHECK(build(fitting).problem.dimension == (plane ? 2 : 3));
  }
  const Packing packing{{0, 1}, {0, 0}, {0.5, 0.5}, {1, 1}, {0, 0}};
  CHECK_THROWS_WITH_AS(assemble(packing, detect_contacts(packing), {{1, {1, 0}}}),
                       "prescribed velocity of grain 1: expected three numbers for a packing in space, met [1, 0]",
                       Error);
  CHECK_THROWS_WITH_AS(assemble(packing, detect_contacts(packing), {{1, {1, 0, not_a_number}}}),
                       "prescribed velocity of grain 1: expected finite components, met (1, 0, nan)", Error);
}

TEST_CASE("assembly refuses missing masses and grains that do not exist") {
  const Packing packing{{0.0, 1.0}, {0.0, 0.0}, {0.5, 0.5}, {}};
  CHECK_THROWS_AS(assemble(packing, detect_contacts(packing)), Error);
  const Packing weighed{{0.0, 1.0}, {0.0, 0.0}, {0.5, 0.5}, {1, 1}};
  CHECK_THROWS_AS(assemble(weighed, detect_contacts(weighed), {{2, {1, 0}}}), Error);
  CHECK_THROWS_AS(assemble(weighed, detect_contacts(weighed), {{0, {not_a_number, 0}}}), Error);
  CHECK_THROWS_AS(assemble(weighed, detect_contacts(weighed), {}, {.compression = {}, .shear = not_a_number}), Error);
  CHECK_THROWS_AS(assemble(weighed, detect_contacts({{0}, {0}, {1}, {1}})), Error);
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
  const ContactSystem contacts(model.problem.inertia, model.problem.h);
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
