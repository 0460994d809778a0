// SPDX-License-Identifier: GPL-3.0-or-later
// Many spheres: what holds of every step, whichever algorithm solves it.
#include "../support/spheres.hpp"
#include "formats/contact_problem/step_fclib.hpp"
#include "linalg/threads.hpp"
#include "mechanics/step_problem.hpp"
#include "two_stage/granular_decomposition.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Vector3 momentum_of_spheres(const Simulation& s) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < s.system.mass.size(); ++i) sum += s.system.mass[i] * velocity_of_ball(s.state, i);
  return sum;
}

Dynamics shaken(double friction) {
  Dynamics dynamics = tight();
  dynamics.interaction.friction = friction;
  dynamics.solver.tolerance = 1e-11;
  return dynamics;
}

}  // namespace

TEST_CASE("spheres: momentum stays, numerical energy is rounding at theta = 1/2, and a step repeats every bit") {
  Dynamics dynamics = shaken(0.4);
  dynamics.time.gravity = {0, 0, 0};
  Simulation one = shaken_cube(4, dynamics), other = one;
  const Vector3 momentum = momentum_of_spheres(one);
  for (int k = 0; k < 5; ++k) {
    const StepReport report = advance_in_space(one);
    advance_in_space(other);
    CHECK((momentum_of_spheres(one) - momentum).norm() < 1e-11);
    CHECK(std::abs(report.energy.numerical) < 1e-12 * report.energy.kinetic * 64);
    CHECK(report.energy.dissipation > -1e-9);
    for (const auto values : numbers_of_grains(3)) CHECK(one.state.*values == other.state.*values);
  }
}

TEST_CASE("spheres: every algorithm finds the velocities of plain sweeps where there is no friction") {
  // Without friction velocities are unique.
  const Simulation whole = shaken_cube(4, shaken(0));
  const GranularStep<3> plain = solve_step<3>(whole);
  REQUIRE(plain.report.status == SolverStatus::converged);
  REQUIRE(plain.report.residual.active > 20);
  for (const char* name : {"generic", "enriched", "schwarz", "newton", "admm", "two_stage_newton", "two_stage_admm"})
    for (const Components<Index>& grid : {Components<Index>{2, 2, 2}, Components<Index>{3, 1, 1}}) {
      CAPTURE(std::string(name));
      Simulation cut = whole;
      cut.partitioner = GridPartitioner{grid};
      cut.dynamics.solver.algorithm = name;
      cut.dynamics.solver.tolerance = cut.dynamics.solver.gluing_tolerance = 1e-10;
      const GranularStep<3> step = solve_step<3>(cut);
      CHECK(step.report.status == SolverStatus::converged);
      CHECK(largest_difference(step.velocities, plain.velocities, 64) < 1e-7);
    }
}

TEST_CASE("spheres: with friction every algorithm solves the step, and cut ones glue") {
  for (const char* name : {"nlgs", "generic", "enriched", "schwarz", "newton", "two_stage_newton", "two_stage_admm"}) {
    CAPTURE(std::string(name));
    Simulation simulation = shaken_cube(4, shaken(0.3), {2, 2, 2});
    simulation.dynamics.solver.algorithm = name;
    simulation.dynamics.solver.tolerance = simulation.dynamics.solver.gluing_tolerance = 1e-9;
    const GranularStep<3> step = solve_step<3>(simulation);
    CHECK(step.report.status == SolverStatus::converged);
    // Of what is kept: the velocities are those of the impulses, and obey the law.
    const std::vector<GrainVelocity<3>> found = velocities_of(step.problem, step.contacts);
    CHECK(largest_difference(found, step.velocities, 64) < 1e-7);
    CHECK(contact_residual(step.problem.law, step.contacts, found).relative_natural_map() < 1e-7);
    CHECK(step.report.residual.stick > 5);
    CHECK(step.report.residual.slide > 5);
  }
}

TEST_CASE("spheres: threads change no bit of Algorithm 1, and one subdomain is plain Gauss-Seidel") {
  Dynamics dynamics = shaken(0.3);
  dynamics.solver.maximum_iterations = 50;
  Simulation simulation = shaken_cube(4, dynamics, {2, 2, 2});
  simulation.dynamics.solver.algorithm = "generic";
  const auto solved = [](const Simulation& s, Index threads) {
    const ThreadLimit limit(threads);
    return solve_step<3>(s).velocities;
  };
  CHECK(largest_difference(solved(simulation, 1), solved(simulation, 2), 64) == 0);
  Simulation plain = simulation, alone = simulation;
  plain.dynamics.solver.algorithm = "nlgs";
  alone.partitioner = GridPartitioner{{1, 1, 1}};
  CHECK(largest_difference(solved(plain, 1), solved(alone, 1), 64) == 0);
}

TEST_CASE("spheres in a plane move as disks do where nothing rubs") {
  const Simulation disks = shaken_lattice(5, 4, shaken(0));
  std::vector<Ball> balls;
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.5, -0.3, 0.7, 0.2).normalized();
  for (std::size_t i = 0; i < disks.system.radius.size(); ++i)
    balls.push_back({.centre = turn * Vector3(disks.state.x[i], disks.state.y[i], 0),
                     .radius = disks.system.radius[i],
                     .mass = disks.system.mass[i],
                     .velocity = turn * Vector3(disks.state.velocity_x[i], disks.state.velocity_y[i], 0)});
  Simulation flat = disks, askew = simulation_of(balls, flat.dynamics);
  const Vector3 gravity = turn * Vector3(0, -g, 0);
  askew.dynamics.time.gravity = {gravity[0], gravity[1], gravity[2]};
  for (int k = 0; k < 3; ++k) {
    advance(flat);
    advance_in_space(askew);
  }
  for (std::size_t i = 0; i < balls.size(); ++i)
    CHECK((centre_of_ball(askew.state, i) - turn * Vector3(flat.state.x[i], flat.state.y[i], 0)).norm() < 1e-9);
}

TEST_CASE("spheres: a step of another dimension is refused by name") {
  const Simulation simulation = shaken_cube(2, shaken(0.3));
  CHECK_THROWS_WITH_AS(solve_step<2>(simulation),
                       "simulation: expected disks in the plane here, met a system of spheres in space", Error);
}

TEST_CASE("spheres: what is remembered, impulses and gluing, is where the next step of a pyramid at rest begins") {
  const double gap = 0.01, out = (1 + gap) / std::sqrt(3.0), height = std::sqrt(1 - out * out);
  for (const char* name : {"nlgs", "generic"}) {
    CAPTURE(std::string(name));
    Dynamics dynamics = shaken(0.8);
    dynamics.time.alert = 0.001;
    dynamics.boundaries = {plane("floor", Vector3::Zero(), Vector3(0, 0, 1))};
    std::vector<Ball> balls{{.centre = {0, 0, 0.5 + height}}};
    for (int k = 0; k < 3; ++k) {
      const double angle = 0.3 + 2 * std::numbers::pi * k / 3;
      balls.push_back({.centre = {out * std::cos(angle), out * std::sin(angle), 0.5}});
    }
    dynamics.solver.algorithm = name;
    dynamics.solver.tolerance = dynamics.solver.gluing_tolerance = 1e-9;
    Simulation simulation = simulation_of(balls, dynamics, {2, 2, 1});
    advance_in_space(simulation, 3);
    const GranularStep<3> cold = solve_step<3>(simulation);
    REQUIRE(cold.report.status == SolverStatus::converged);
    CHECK((cold.report.interface_size > 0) == (std::string_view(name) == "generic"));
    CHECK(cold.report.residual.stick == 6);
    simulation.dynamics.solver.warm_start = true;
    const GranularStep<3> warm = solve_step<3>(simulation);
    CHECK(cold.report.last.iteration > 10);
    CHECK(warm.report.last.iteration <= 2);
  }
}

TEST_CASE("spheres: the contact problem of a step, and of each subdomain, is solved by what the run found") {
  Simulation simulation = shaken_cube(3, shaken(0.3), {2, 1, 2});
  simulation.dynamics.solver.algorithm = "generic";
  simulation.dynamics.solver.gluing_tolerance = 1e-11;
  const Simulation before = simulation;
  const GranularStep<3> solved = solve_step<3>(simulation);
  take_step(simulation, solved);
  const TrajectoryStep after = TrajectoryStep{simulation.state, trajectory_contacts(solved)};
  const auto require_solution = [&](const FclibFile& file) {
    const auto& problem = std::get<GlobalFrictionProblem>(file.problem);
    REQUIRE(file.solution.has_value());
    CHECK(problem.dimension == 3);
    CHECK((body_velocities(problem, file.solution->r) - file.solution->v).norm() < 1e-9);
    CHECK((problem.h.transpose() * file.solution->v + problem.w - file.solution->u).norm() < 1e-12);
    return problem;
  };
  const auto whole = require_solution(fclib_of_step(before, &after));
  CHECK(whole.mass.rows() == 6 * 27);
  CHECK(whole.mass.coeff(0, 0) == 1);
  CHECK(whole.mass.coeff(3, 3) == doctest::Approx(0.4 * 0.25));
  for (Index e = 0; e < 4; ++e) {
    const FclibFile file = fclib_of_subdomain(before, after, e);
    const auto& problem = std::get<GlobalFrictionProblem>(file.problem);
    // The impulses of the interface are loads: grains of a subdomain move as in the whole.
    const Vector v = body_velocities(problem, file.solution->r);
    std::set<Index> grains;
    for (std::size_t k = 0; k < solved.contacts.size(); ++k)
      if (solved.partition.subdomain_of_contact[k] == e)
        grains.insert({solved.problem.geometry[k].a, solved.problem.geometry[k].b});
    REQUIRE(v.size() == 6 * count(grains));
    Index row = 0;
    for (const Index grain : grains) {
      const GrainUnknowns<3> expected = motion_of(after.state, at(grain), 1);
      for (const double one : expected) CHECK(std::abs(v[row++] - one) < 1e-8);
    }
  }
}

TEST_CASE("interleaved sweeps in space follow a curve from neighbour to neighbour") {
  StepProblem<3> problem;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 8; ++k) {
        const auto body = static_cast<std::int32_t>(problem.free.size());
        problem.contacts.push_back({.a = body, .b = body + 1});  // none shares a body: one colour
        problem.geometry.push_back({.point = {0.1 * i, 0.1 * j, 0.1 * k}});
        problem.free.resize(problem.free.size() + 2, {.inverse_mass = 1});
      }
  const Index contacts = count(problem.contacts);
  GreedyColours taken(count(problem.free));
  const std::vector<Index> order = contact_order("interleaved", problem, natural_order(contacts), 1, taken);
  REQUIRE(count(std::set<Index>(order.begin(), order.end())) == contacts);
  for (std::size_t k = 1; k < order.size(); ++k) {
    double steps = 0;
    for (std::size_t d = 0; d < 3; ++d)
      steps += std::abs(problem.geometry[at(order[k])].point[d] - problem.geometry[at(order[k - 1])].point[d]) / 0.1;
    CHECK(steps == doctest::Approx(1));
  }
}
