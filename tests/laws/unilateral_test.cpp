// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/dense.hpp"
#include "../support/problems.hpp"
#include "../support/projected_gradients.hpp"
#include "linalg/random.hpp"
#include "mechanics/active_set.hpp"
#include "mechanics/gauss_seidel.hpp"
#include "study/linear/inspection.hpp"
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Dense delassus(const ReferenceProblem& problem) {
  const Dense h = problem.h;
  return h.transpose() * diagonal(problem.inertia.cwiseInverse()) * h;
}

// w of the complementarity problem by trying every set of carrying contacts.
Vector by_enumeration(const Dense& w, const Vector& b) {
  const Index n = b.size();
  for (Index set = 0; set < (Index{1} << n); ++set) {
    std::vector<Index> in;
    for (Index i = 0; i < n; ++i)
      if (set >> i & 1) in.push_back(i);
    Vector r = Vector::Zero(n);
    if (!in.empty()) {
      const Matrix part = w.entries()(in, in);
      r(in) = least_norm_solution(part, -b(in));
    }
    const Vector separation = w * r + b;
    if (r.minCoeff() > -1e-10 && separation.minCoeff() > -1e-10 && std::abs(r.dot(separation)) < 1e-10)
      return separation;
  }
  return {};
}

// The law of a frictionless contact without restitution, for sweeps that know nothing of the solver.
struct SignoriniLaw {
  double impulse(double free_velocity, double delassus) const { return std::max(0.0, -free_velocity / delassus); }
};

void load_at_random(ReferenceProblem& problem, std::uint64_t seed) {
  problem.arriving_velocity = RandomStream(seed).normal_vector(problem.inertia.size());
}

double energy(const ReferenceProblem& problem, const Vector& v) { return 0.5 * v.dot(problem.inertia.cwiseProduct(v)); }

enum class Method { interior_point, projected_gradients };
constexpr Method both[] = {Method::interior_point, Method::projected_gradients};

UnilateralImpulses solve(const ReferenceProblem& problem, Method method, std::optional<Index> maximum_iterations = {},
                         const Monitor& monitor = {}) {
  UnilateralOptions cone;
  QuadraticOptions quadratic;
  if (maximum_iterations) cone.maximum_iterations = quadratic.maximum_iterations = *maximum_iterations;
  return method == Method::interior_point ? unilateral_impulses(problem, cone, monitor)
                                          : by_projected_gradients(problem, quadratic, monitor);
}

// Seven disks, one in the middle: 12 contacts, of rank 11.
Case hexagon() {
  Packing packing = generate(HexagonalLattice{.columns = 3, .rows = 3});
  for (const Index corner : {6, 0})
    for (auto* values : {&packing.x, &packing.y, &packing.radius}) values->erase(values->begin() + corner);
  Case one;
  one.spec.packing = PackingFile{"hexagon"};
  one.packing = packing;
  return one;
}

// The case that moves by a deformation only.
Case deformed(Case one, const Loads& loads) {
  one.spec.prescribed.clear();
  one.spec.loads = loads;
  return one;
}

// Lattices with vacancies, every kind of load.
std::vector<ReferenceProblem> loaded_problems() {
  std::vector<ReferenceProblem> all;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Case one = random_lattice(seed, 14, 12, {1, 1});
    all.push_back(build(one).problem);  // one grain hits the others
    all.push_back(build(deformed(one, {{1.0, 1.0}, 0.0})).problem);
    all.push_back(build(deformed(one, {{1.0, -0.5}, 0.7})).problem);
    load_at_random(all.emplace_back(all.back()), seed);
  }
  const Case spheres = random_fcc(1, 7, 6, 6, GridPartitioner{{1, 1, 1}});
  all.push_back(build(spheres).problem);
  all.push_back(build(deformed(spheres, {{1.0, -0.5, 0.5}, 0.7})).problem);
  load_at_random(all.emplace_back(all.back()), 4);
  return all;
}

}  // namespace

TEST_CASE("unilateral: two disks share their momentum, or part") {
  const Packing packing{{0.0, 1.0}, {0.0, 0.0}, {0.5, 0.5}, {1.0, 3.0}};
  for (const Method method : both) {
    const UnilateralImpulses hit = solve(assemble(packing, detect_contacts(packing), {{1, {-1.0, 0.0}}}), method);
    CHECK(hit.impulses[0] == doctest::Approx(0.75));
    CHECK(hit.velocities[0] == doctest::Approx(-0.75));
    CHECK(hit.velocities[2] == doctest::Approx(-0.75));
    CHECK(hit.count(UnilateralStatus::carrying) == 1);
    const UnilateralImpulses leaving = solve(assemble(packing, detect_contacts(packing), {{1, {1.0, 0.0}}}), method);
    CHECK(leaving.impulses[0] == 0);
    CHECK(leaving.count(UnilateralStatus::open) == 1);
    CHECK(leaving.residual == 0);
    CHECK(leaving.converged);
  }
}

TEST_CASE("unilateral: every solution of packings of up to 12 contacts, by enumeration of all sets") {
  Index partly_open = 0, hyperstatic = 0, cases = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Case one = seed % 5 == 0   ? (seed % 2 == 0 ? two_tetrahedra() : octahedron())
               : seed % 3 == 0 ? hexagon()
               : seed % 3 == 1 ? random_lattice(seed, 3, 3, {1, 1})
                               : strip(4 + static_cast<Index>(seed % 4));
    ReferenceProblem problem = build(one).problem;
    if (problem.contacts() == 0 || problem.contacts() > 12) continue;
    load_at_random(problem, seed);
    const Dense w = delassus(problem);
    const Vector expected = by_enumeration(w, problem.h.transpose() * problem.arriving_velocity);
    REQUIRE(expected.size() == problem.contacts());
    for (const Method method : both) {
      const UnilateralImpulses found = solve(problem, method);
      CAPTURE(seed);
      CHECK(found.converged);
      CHECK((found.separation - expected).cwiseAbs().maxCoeff() < 1e-7);
      for (Index c = 0; c < problem.contacts(); ++c)
        if (found.status[at(c)] == UnilateralStatus::open) CHECK(expected[c] > 0);
      if (found.count(UnilateralStatus::open) > 0 && found.count(UnilateralStatus::carrying) > 0) ++partly_open;
    }
    hyperstatic += rank(w) < problem.contacts();
    ++cases;
  }
  CHECK(cases >= 20);
  CHECK(partly_open >= 20);
  CHECK(hyperstatic >= 8);
}

TEST_CASE("unilateral: where no bilateral impulse pulls, it is the answer; least norm by projected gradients") {
  // Isotropic compression of a whole lattice of equal disks loads every contact.
  Case one;
  one.spec.packing = Generator{HexagonalLattice{.columns = 7, .rows = 6}};
  one.spec.loads = {{1.0, 1.0}, 0.0};
  const ReferenceProblem problem = build(one).problem;
  const RigidImpulses bilateral = rigid_impulses(problem);
  REQUIRE(bilateral.impulses.minCoeff() > 0);
  REQUIRE_FALSE(bilateral.unique);
  const UnilateralImpulses least = by_projected_gradients(problem, {.tolerance = 1e-12});
  CHECK((least.impulses - bilateral.impulses).norm() < 1e-7 * bilateral.impulses.norm());
  const UnilateralImpulses inner = unilateral_impulses(problem);
  CHECK(inner.count(UnilateralStatus::carrying) == problem.contacts());
  CHECK(inner.velocities.cwiseAbs().maxCoeff() < 1e-7);
  // An isostatic packing has one answer for all.
  const ReferenceProblem triangle = build(deformed(strip(3), one.spec.loads)).problem;
  REQUIRE(rigid_impulses(triangle).unique);
  REQUIRE(rigid_impulses(triangle).impulses.minCoeff() > 0);
  CHECK((unilateral_impulses(triangle).impulses - rigid_impulses(triangle).impulses).norm() < 1e-8);
}

TEST_CASE("unilateral: complementarity on hundreds of contacts, from quantities computed afresh") {
  for (const ReferenceProblem& problem : loaded_problems()) {
    REQUIRE(problem.contacts() > 250);
    for (const Method method : both) {
      const UnilateralImpulses found = solve(problem, method);
      CHECK(found.converged);
      CHECK(found.iterations > 0);
      if (method == Method::interior_point) CHECK(found.iterations <= 28);  // few, whatever the packing
      const Dense w = delassus(problem);
      const Vector b = problem.h.transpose() * problem.arriving_velocity;
      const Vector separation = w * found.impulses + b;
      const Vector root = w.entries().diagonal().cwiseSqrt();
      const double scale = b.cwiseQuotient(root).cwiseAbs().maxCoeff();
      CHECK(found.impulses.minCoeff() >= 0);
      REQUIRE(found.count(UnilateralStatus::open) > 0);
      for (Index c = 0; c < problem.contacts(); ++c)
        if (found.status[at(c)] == UnilateralStatus::open) CHECK(found.impulses[c] == 0);
      CHECK((separation - found.separation).cwiseAbs().maxCoeff() < 1e-9 * scale);
      const Vector natural_map = found.impulses.cwiseProduct(root).cwiseMin(separation.cwiseQuotient(root));
      CHECK(natural_map.cwiseAbs().maxCoeff() < 2e-8 * scale);
      CHECK(found.residual <= 1e-8);
    }
  }
}

TEST_CASE("unilateral: momentum is kept, energy only lost, and V is the nearest admissible velocity") {
  for (const ReferenceProblem& problem : loaded_problems()) {
    const UnilateralImpulses found = unilateral_impulses(problem, {.tolerance = 1e-10});
    REQUIRE(found.converged);
    const Vector before = problem.inertia.cwiseProduct(problem.arriving_velocity);
    const Vector after = problem.inertia.cwiseProduct(found.velocities);
    Vector momentum = Vector::Zero(problem.dimension);
    for (Index i = 0; i < problem.grains(); ++i)
      momentum += (after - before).segment(problem.dimension * i, problem.dimension);
    CHECK(momentum.norm() < 1e-9 * before.norm());
    CHECK(energy(problem, found.velocities) < energy(problem, problem.arriving_velocity));
    // <M (V^- - V), U - V> <= 0 for every admissible U: here U = 0, rigid motions and V itself doubled
    const Vector force = before - after;
    CHECK(force.dot(found.velocities) >= -1e-7 * before.squaredNorm());
    CHECK(std::abs(force.dot(found.velocities)) < 1e-7 * before.squaredNorm());
  }
}

TEST_CASE("unilateral: velocities are the same from any start, method and order; the interior point carries all") {
  Index more = 0;
  for (const ReferenceProblem& problem : loaded_problems()) {
    const UnilateralImpulses interior = unilateral_impulses(problem);
    const double speed = problem.arriving_velocity.cwiseAbs().maxCoeff();
    // projected gradients from a random start
    const Dense w = delassus(problem);
    const Vector b = problem.h.transpose() * problem.arriving_velocity;
    const LinearMap apply = [&](const Vector& x) -> Vector { return w * x; };
    const Vector start = 10 * RandomStream(5).normal_vector(b.size());
    const NonnegativeMinimum other = minimize_nonnegative(apply, b, w.entries().trace(), start, {.tolerance = 1e-9});
    REQUIRE(other.converged);
    CHECK((other.gradient - interior.separation).cwiseAbs().maxCoeff() < 1e-5 * speed);
    // nonlinear Gauss-Seidel
    const ContactSystem contacts(problem.inertia, problem.h);
    Vector r = Vector::Zero(b.size()), v = problem.arriving_velocity;
    const auto off = [&] { return (v - interior.velocities).cwiseAbs().maxCoeff(); };
    for (int sweep = 0; sweep < 20000 && !(sweep % 100 == 0 && off() < 1e-5 * speed); ++sweep)
      gauss_seidel_sweep(contacts, SignoriniLaw{}, r, v);
    CHECK(off() < 1e-5 * speed);
    // twice the same, bit for bit
    CHECK(unilateral_impulses(problem).impulses == interior.impulses);
    // carrying wherever another solution does
    const UnilateralImpulses gradients = by_projected_gradients(problem, {.tolerance = 1e-10});
    const double largest = gradients.impulses.maxCoeff();
    for (Index c = 0; c < problem.contacts(); ++c) {
      if (gradients.impulses[c] > 1e-4 * largest) CHECK(interior.status[at(c)] == UnilateralStatus::carrying);
      more += interior.status[at(c)] == UnilateralStatus::carrying && gradients.impulses[c] == 0;
    }
  }
  CHECK(more > 0);
}

TEST_CASE("unilateral: other units of mass and velocity change impulses by their product only; eight decades of mass") {
  const ReferenceProblem problem = build(random_lattice(2, 12, 12, {1, 1})).problem;
  const UnilateralImpulses plain = unilateral_impulses(problem);
  ReferenceProblem scaled = problem;
  scaled.inertia *= 1000;
  scaled.arriving_velocity *= 1e-6;
  const UnilateralImpulses other = unilateral_impulses(scaled);
  CHECK(other.converged);
  CHECK(other.status == plain.status);
  CHECK(other.iterations == plain.iterations);
  CHECK((other.velocities * 1e6 - plain.velocities).norm() < 1e-9 * plain.velocities.norm());
  CHECK((other.impulses * 1e3 - plain.impulses).norm() < 1e-6 * plain.impulses.norm());

  ReferenceProblem decades = build(random_lattice(1, 14, 12, {1, 1})).problem;
  RandomStream random(3);
  for (Index i = 0; i < decades.grains(); ++i)
    decades.inertia.segment(2 * i, 2).setConstant(std::pow(10.0, 8 * random.uniform() - 4));
  const UnilateralImpulses found = unilateral_impulses(decades);
  CHECK(found.converged);
  CHECK(found.count(UnilateralStatus::carrying) > 0);
}

TEST_CASE("unilateral: contacts that nothing moves are idle, a load that pulls opens all; no contacts, no load") {
  const Packing packing{{0.0, 1.0, 5.0, 6.0}, {0, 0, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {1, 1, 1, 1}};
  const ReferenceProblem problem = assemble(packing, detect_contacts(packing), {{1, {-1.0, 0.0}}});
  const UnilateralImpulses found = unilateral_impulses(problem);
  CHECK(found.status == std::vector<UnilateralStatus>{UnilateralStatus::carrying, UnilateralStatus::idle});
  const ReferenceProblem pulled = build(deformed(random_lattice(1, 8, 8, {1, 1}), {{-1.0, -1.0}, 0.0})).problem;
  const UnilateralImpulses apart = unilateral_impulses(pulled);
  CHECK(apart.count(UnilateralStatus::open) == pulled.contacts());
  CHECK(apart.impulses.isZero(0));
  CHECK(apart.velocities == pulled.arriving_velocity);
  const Packing two{{0.0, 5.0}, {0.0, 0.0}, {0.5, 0.5}, {1, 1}};
  const UnilateralImpulses none = unilateral_impulses(assemble(two, detect_contacts(two), {{1, {-1.0, 0.0}}}));
  CHECK(none.converged);
  CHECK(none.impulses.size() == 0);
  const Model still = build(deformed(strip(4), {}));
  CHECK(unilateral_impulses(still.problem).count(UnilateralStatus::idle) == 5);
  CHECK_THROWS_WITH_AS(choose_contacts(still, ContactSet::unilateral),
                       doctest::Contains("expected a prescribed velocity"), Error);
}

TEST_CASE("unilateral: want of convergence is data, and a monitor stops the work") {
  const ReferenceProblem problem = build(random_lattice(1, 14, 12, {1, 1})).problem;
  for (const Method method : both) {
    const UnilateralImpulses few = solve(problem, method, 4);
    CHECK_FALSE(few.converged);
    CHECK(few.residual > 1e-8);
    CHECK(few.residual < infinity);
    Index calls = 0;
    const UnilateralImpulses stopped = solve(problem, method, {}, [&](Index, Index) { return ++calls < 3; });
    CHECK(calls == 3);
    CHECK_FALSE(stopped.converged);
  }
}

TEST_CASE("loads: a homogeneous deformation without momentum, overruled grain by grain") {
  Case one = random_lattice(1, 6, 5, {1, 1});
  one.spec.prescribed = {{2, {0.25, -0.5}}};
  override_case(one.spec, "loads.compression", "2,3");
  override_case(one.spec, "loads.shear", "0.5");
  const Model model = build(one);
  const Vector& v = model.problem.arriving_velocity;
  CHECK(v[4] == 0.25);
  CHECK(v[5] == -0.5);
  const double dx = model.packing.x[7] - model.packing.x[4], dy = model.packing.y[7] - model.packing.y[4];
  CHECK(v[14] - v[8] == doctest::Approx(-2 * dx + 0.5 * dy));
  CHECK(v[15] - v[9] == doctest::Approx(0.5 * dx - 3 * dy));
  one.spec.prescribed.clear();
  const ReferenceProblem free = build(one).problem;
  const Vector momentum = free.inertia.cwiseProduct(free.arriving_velocity);
  double x = 0;
  for (Index i = 0; i < free.grains(); ++i) x += momentum[2 * i];
  CHECK(std::abs(x) < 1e-12 * momentum.norm());
  CHECK_THROWS_WITH_AS(override_case(one.spec, "loads.gravity", "1"),
                       doctest::Contains("loads.compression, loads.shear"), Error);
  CHECK_THROWS_AS(override_case(one.spec, "loads.shear", "inf"), Error);
}

TEST_CASE("choice of contacts: rule and solution say whether impulses are unique") {
  Case two_spheres;  // six rigid motions, one of which turns the pair about itself
  two_spheres.spec.packing = PackingFile{"made in a test"};
  two_spheres.packing = {{0, 1}, {0, 0}, {0.5, 0.5}, {1, 1}, {0, 0}};
  two_spheres.spec.prescribed = {{0, {1, 0, 0}}};
  for (const Case& one : {strip(8), two_tetrahedra(), octahedron(), two_spheres}) {
    CAPTURE(one.spec.name);
    const ContactChoice isostatic = choose_contacts(build(one), ContactSet::unilateral);
    CHECK(isostatic.rule == "complementarity (unique)");
    CHECK(isostatic.certain);
  }
  const Case squeezed = deformed(random_fcc(2, 5, 5, 4, GridPartitioner{{1, 1, 1}}), {{1.0, 1.0, 1.0}, 0.0});
  CHECK(choose_contacts(build(squeezed), ContactSet::unilateral).rule == "complementarity (maximal)");
  const Model compressed = build(deformed(random_lattice(2, 10, 9, {2, 1}), {{1.0, 1.0}, 0.0}));
  const ContactChoice hyperstatic = choose_contacts(compressed, ContactSet::unilateral);
  CHECK(hyperstatic.rule == "complementarity (maximal)");
  CHECK(hyperstatic.solution == "unilateral_maximal");
  const Selection selection = select(compressed, ContactSet::unilateral);
  const Index chosen = selection.of_case.active_contacts;
  CHECK(chosen == std::count(hyperstatic.active.begin(), hyperstatic.active.end(), 1));
  CHECK(chosen > 0);
  CHECK(chosen < compressed.problem.contacts());
  CHECK(selection.of_case.contact_set == ContactSet::unilateral);
  Index active = 0;
  links(
      compressed,
      [&](const Link& link) {
        active += link.choice.active[at(link.number)] != 0;
        CHECK(link.impulse >= 0);
      },
      ContactSet::unilateral);
  CHECK(active == chosen);
}
