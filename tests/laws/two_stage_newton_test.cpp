// SPDX-License-Identifier: GPL-3.0-or-later
// The two-stage Newton method and ADMM: steps solved by a contact solver whose linear systems are cut into subdomains.
#include "../support/granular.hpp"
#include "linalg/threads.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr double map_tolerance = 1e-10;

Dynamics newton(const std::string& law, double restitution = 0) {
  Dynamics dynamics = tight();
  dynamics.interaction.law = law;
  dynamics.interaction.friction = 0.5;
  dynamics.interaction.cohesion = 20;
  dynamics.interaction.restitution = dynamics.interaction.tangential_restitution = restitution;
  dynamics.solver.algorithm = "two_stage_newton";
  dynamics.solver.tolerance = map_tolerance;
  return dynamics;
}

GranularStep<2> undivided(Simulation simulation, const std::string& algorithm = "auto") {
  simulation.dynamics.solver.algorithm = algorithm;
  return solve_step(simulation);
}

// By the same algorithm, on one subdomain.
GranularStep<2> in_one_piece(Simulation simulation) {
  simulation.partitioner = GridPartitioner{.grid = {1, 1}};
  return solve_step(simulation);
}

// Of the velocities that are kept, by the routine that judges sweeps.
double natural_map_of(const GranularStep<2>& step) {
  return contact_residual(step.problem.law, step.contacts, step.velocities).relative_natural_map();
}

void check_solved(const Simulation& simulation, const GranularStep<2>& found, const GranularStep<2>& expected) {
  CHECK(found.report.status == SolverStatus::converged);
  CHECK(natural_map_of(found) < 10 * map_tolerance);
  // Impulses need not be unique, nor which contacts have any; where grains go is, next to always.
  const Index disks = simulation.system.grains();
  CHECK(largest_difference(found.velocities, expected.velocities, disks) <
        1e-6 * largest_speed(expected.velocities, disks));
}

}  // namespace

TEST_CASE("steps cut into subdomains end as undivided ones do, with any law and any cut") {
  for (const std::string law : {"coulomb", "frictionless", "cohesive"})
    for (const double restitution : {0.0, 0.4})
      for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {2, 2}, {4, 2}}) {
        INFO("law = ", law, ", restitution = ", restitution, ", grid[0] * grid[1] = ", grid[0] * grid[1]);
        const Simulation simulation = shaken_lattice(10, 8, newton(law, restitution), grid);
        const GranularStep<2> found = solve_step(simulation), expected = undivided(simulation);
        check_solved(simulation, found, expected);
        CHECK(found.report.interface_size > 0);
        // Sweeps, steps along the curve and Newton's ones do not depend on the cut, to rounding.
        const GranularStep<2> one = in_one_piece(simulation);
        const Index steps = one.report.factorisations;
        CHECK(one.report.interface_size == 0);
        CHECK(found.report.last.sweeps == one.report.last.sweeps);
        CHECK(std::abs(found.report.factorisations - steps) <= 1 + steps / 10);
        CHECK(found.report.interface_iterations >= found.report.factorisations);
        if (law != "frictionless" || restitution == 0) CHECK(steps > 0);  // there sweeps do
      }
}

TEST_CASE("every network of Stage 2 leads to the same answer") {
  Simulation simulation = shaken_lattice(10, 8, newton("coulomb"), {3, 2});
  const GranularStep<2> expected = undivided(simulation);
  using enum InterfacePreconditioner;
  for (const InterfacePreconditioner stage_two : {inertia, network, active}) {
    CAPTURE(stage_two);
    simulation.dynamics.solver.interface_preconditioner = stage_two;
    check_solved(simulation, solve_step(simulation), expected);
  }
}

TEST_CASE("two-stage ADMM takes the iterations of undivided ADMM, and one at the interface for each with X_rho") {
  for (const std::string law : {"coulomb", "frictionless", "cohesive"})
    for (const std::string stage_two : {"X_eta_active", "X"}) {
      INFO("law = ", law, ", Stage 2 by ", stage_two);
      Simulation simulation = shaken_lattice(10, 8, newton(law), {4, 2});
      simulation.dynamics.solver.algorithm = "two_stage_admm";
      simulation.dynamics.solver.interface_preconditioner = stage_two;
      const GranularStep<2> found = solve_step(simulation), expected = undivided(simulation, "admm");
      check_solved(simulation, found, expected);
      const Index iterations = expected.report.last.sweeps;
      CHECK(std::abs(found.report.last.sweeps - iterations) <= (stage_two == "X_eta_active" ? 0 : iterations / 20));
      CHECK(found.report.factorisations == expected.report.factorisations);
      CHECK(found.report.interface_systems == found.report.last.sweeps);
      if (stage_two == "X_eta_active")
        CHECK(found.report.interface_iterations == found.report.interface_systems);
      else  // conjugate gradients, preconditioned by X
        CHECK(found.report.interface_iterations > 5 * found.report.interface_systems);
    }
}

TEST_CASE("steps cut into subdomains have the same bits for any number of threads") {
  for (const std::string algorithm : {"two_stage_newton", "two_stage_admm"}) {
    Simulation simulation = shaken_lattice(10, 8, newton("coulomb"), {4, 2});
    simulation.dynamics.solver.algorithm = algorithm;
    const auto with_threads = [&](Index threads) {
      const ThreadLimit limit(threads);
      return solve_step(simulation);
    };
    const GranularStep<2> one = with_threads(1), two = with_threads(2);
    CHECK(one.report.interface_iterations == two.report.interface_iterations);
    for (std::size_t k = 0; k < one.contacts.size(); ++k) {
      CHECK(one.contacts[k].impulse.n == two.contacts[k].impulse.n);
      CHECK(one.contacts[k].impulse.t == two.contacts[k].impulse.t);
    }
  }
}

TEST_CASE("the two-stage Newton method solves steps of one contact and of none") {
  Dynamics dynamics = newton("coulomb");
  dynamics.boundaries = {floor_wall()};
  const Simulation falling = simulation_of(std::vector<Grain>{{.x = 0, .y = 5}}, dynamics, {2, 1});
  const GranularStep<2> free = solve_step(falling);
  CHECK(free.report.status == SolverStatus::converged);
  CHECK(free.contacts.empty());
  CHECK(free.velocities[0].y == doctest::Approx(-g * dynamics.time.step));
  const Simulation resting = simulation_of(std::vector<Grain>{{.x = 0, .y = 0.5}}, dynamics, {2, 1});
  const GranularStep<2> held = solve_step(resting);
  CHECK(held.report.status == SolverStatus::converged);
  REQUIRE(held.contacts.size() == 1);
  CHECK(std::abs(held.contacts[0].impulse.n) == doctest::Approx(g * dynamics.time.step));
  CHECK(std::abs(held.velocities[0].y) < 1e-9);
}
