// SPDX-License-Identifier: GPL-3.0-or-later
// Contact problems of steps cut into subdomains, against the stored W of the whole step.
#include "../support/literal_sweeps.hpp"
#include "../support/sanitized.hpp"
#include "../support/spheres.hpp"
#include "contact_solvers/stored_contacts.hpp"
#include "linalg/random.hpp"
#include "linalg/threads.hpp"
#include "simulation/contact_solver_step.hpp"
#include "simulation/step_decomposition.hpp"

#include <doctest/doctest.h>

#include <numbers>
#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// The next step of a simulation, cut as its solver says, and as a whole.
template <int D>
struct Divided {
  explicit Divided(const Simulation& simulation) : Divided(simulation, divide_step<D>(simulation)) {}
  Divided(const Simulation& simulation, std::pair<GranularStep<D>, GranularDecomposition<D>> divided)
      : step(std::move(divided.first)),
        whole(contact_problem(step.problem, simulation.system)),
        colours(contact_colours(simulation, step.problem.geometry)),
        contacts(step.problem, step.partition, std::move(divided.second), colours,
                 CutContacts<D>(linear_decomposition(simulation, step), {}), Refinement::one_step) {}

  GranularStep<D> step;
  LocalFrictionProblem whole;
  ContactColours colours;
  DividedContacts<D> contacts;
};

Dynamics cut_dynamics(const std::string& law, double restitution = 0) {
  Dynamics dynamics = tight();
  dynamics.solver.algorithm = "two_stage_newton";
  dynamics.interaction.law = law;
  dynamics.interaction.friction = 0.5;
  dynamics.interaction.cohesion = 20;
  dynamics.interaction.restitution = dynamics.interaction.tangential_restitution = restitution;
  return dynamics;
}

// By colours.
template <int D>
std::vector<Index> order_of(const Divided<D>& divided) {
  std::vector<Index> order = natural_order(divided.whole.contacts());
  std::ranges::stable_sort(order, {}, [&](Index c) { return divided.colours.of_contact[at(c)]; });
  return order;
}

template <int D>
void check_against_whole(const Simulation& simulation, const std::string& algorithm_of_sweeps) {
  CAPTURE(algorithm_of_sweeps);
  Divided<D> divided(simulation);
  const LocalFrictionProblem& whole = divided.whole;
  REQUIRE(whole.contacts() > 20);
  RandomStream random(3);
  const Vector r = random.normal_vector(whole.size());
  CHECK((divided.contacts.product(r) - whole.w * r).norm() < 1e-13 * (whole.w * r).norm());
  const ContactData& data = divided.contacts.data;
  CHECK((data.q - whole.q).norm() < 1e-13 * whole.q.norm());
  const Vector start = r.cwiseAbs();
  for (const auto& [omega, momentum] : {std::pair(1.0, 0.0), {0.7, 0.0}, {1.0, 0.8}}) {
    const Vector expected = literal_sweeps<D>(whole, order_of(divided), start, 3, omega, momentum),
                 found = divided.contacts.swept(start, {.many = 3, .momentum = momentum}, omega);
    CHECK((found - expected).norm() < 1e-12 * expected.norm());
    CHECK((expected - start).norm() > 0.1 * start.norm());
  }
  // What a solver is given.
  const StoredContacts<D> stored(whole);
  CHECK(data.friction == whole.friction);
  CHECK((data.normal - stored.data.normal).norm() < 1e-12 * data.normal.norm());
  CHECK(data.alone == doctest::Approx(stored.data.alone).epsilon(1e-12));
  CHECK(data.trace == doctest::Approx(stored.data.trace).epsilon(1e-12));
  const Vector ones = Vector::Ones(whole.size());
  CHECK(data.sums.norm(r) == doctest::Approx(r.norm()));
  CHECK(data.sums.dot(r, ones) == doctest::Approx(r.sum()));
  CHECK(data.sums.largest(r.cwiseAbs()) == r.cwiseAbs().maxCoeff());
}

template <int D>
void check_colours(const Simulation& simulation, const GranularStep<D>& step, const ContactColours& colours) {
  std::set<std::pair<Index, Index>> met;  // colour and free grain
  for (std::size_t c = 0; c < step.problem.geometry.size(); ++c)
    for (const Index body : {step.problem.geometry[c].a, step.problem.geometry[c].b})
      if (body < simulation.system.grains() && simulation.system.free(body))
        CHECK(met.insert({colours.of_contact[c], body}).second);
}

}  // namespace

TEST_CASE("W of a step that is cut, never formed, is that of the whole step, and so are sweeps by colours") {
  for (const std::string law : {"coulomb", "frictionless", "cohesive"})
    for (const double restitution : {0.0, 0.4})
      for (const std::array<Index, 2> grid : {std::array<Index, 2>{1, 1}, {3, 2}}) {
        INFO("law = ", law, ", restitution = ", restitution);
        const Dynamics dynamics = cut_dynamics(law, restitution);
        check_against_whole<2>(shaken_lattice(6, 5, dynamics, grid), "disks");
        check_against_whole<3>(shaken_cube(3, dynamics, {grid[0], grid[1], 1}), "spheres");
      }
}

TEST_CASE("the cut of a step changes neither its colours nor, but for rounding, its sweeps") {
  Vector first;
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{1, 1}, {4, 1}, {3, 3}}) {
    Dynamics dynamics = cut_dynamics("coulomb");
    dynamics.boundaries = {wall("floor", {0, -0.5}, {1, -0.5})};
    const Simulation simulation = shaken_lattice(12, 9, dynamics, grid);
    Divided<2> divided(simulation);
    check_colours(simulation, divided.step, divided.colours);
    const Vector found = divided.contacts.swept(Vector::Zero(divided.whole.size()), {.many = 20}, 1);
    if (first.size() == 0) first = found;
    CHECK((found - first).norm() < 1e-11 * first.norm());
    // Equal bits for any number of threads.
    const ThreadLimit limit(1);
    CHECK(divided.contacts.swept(Vector::Zero(divided.whole.size()), {.many = 20}, 1) == found);
  }
}

TEST_CASE("a grain with very many contacts takes as many colours, and shares them with nobody") {
  constexpr int around = 150;
  std::vector<Grain> grains{{.x = 0, .y = 0, .radius = 10, .mass = 100}};
  const double angle = 2 * std::numbers::pi / around, radius = 0.2;
  for (int k = 0; k < around; ++k)
    grains.push_back({.x = (10 + radius) * std::cos(k * angle),
                      .y = (10 + radius) * std::sin(k * angle),
                      .radius = radius,
                      .mass = 1,
                      .velocity_x = -std::cos(k * angle),
                      .velocity_y = -std::sin(k * angle)});
  const Simulation simulation = simulation_of(grains, cut_dynamics("coulomb"), {3, 3});
  Divided<2> divided(simulation);
  CHECK(divided.colours.number == around);
  check_colours(simulation, divided.step, divided.colours);
  const Vector found = divided.contacts.swept(Vector::Zero(divided.whole.size()), {.many = 2}, 1);
  const Vector expected =
      literal_sweeps<2>(divided.whole, order_of(divided), Vector::Zero(divided.whole.size()), 2, 1, 0);
  CHECK((found - expected).norm() < 1e-12 * expected.norm());
  // The large disk is in all subdomains, which leave it with one velocity.
  const std::vector<GrainVelocity<2>> velocities = divided.contacts.velocities(found);
  const Vector u = divided.whole.w * found + divided.whole.q;
  for (Index c = 0; c < divided.whole.contacts(); ++c) {
    const GrainContact<2>& contact = divided.step.problem.contacts[at(c)];
    CHECK(relative_velocity(contact, velocities).n + contact.bias.n == doctest::Approx(u[2 * c]).epsilon(1e-9));
  }
}

TEST_CASE("very many contacts of a step that is cut are swept: gradients need a stored W" * doctest::skip(sanitized)) {
  Dynamics dynamics = cut_dynamics("coulomb");
  dynamics.time.gravity = {0, 0};
  std::vector<Grain> row;  // neighbours collide in pairs at q_m
  for (int k = 0; k < 100'002; ++k) {
    const double speed = k % 2 == 0 ? 1 : -1;
    row.push_back({.x = k - dynamics.time.step * speed / 2, .velocity_x = speed});
  }
  const GranularStep<2> step = solve_step(simulation_of(row, dynamics, {2, 1}));
  CHECK(step.report.contacts > 100'000);
  CHECK(step.report.status == SolverStatus::converged);
  CHECK(step.report.last.sweeps > 0);
  for (const GrainMotion& velocity : step.all_grains) REQUIRE(std::abs(velocity[0]) < 1e-9);
}
