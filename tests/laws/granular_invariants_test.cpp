// SPDX-License-Identifier: GPL-3.0-or-later
// Balances of energy, momentum and angular momentum, and symmetries, on packings of many grains.
#include "../support/granular.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

double total_energy(const StepEnergy& e) { return e.kinetic + e.potential; }

// Sum over disks of x cross m V + I spin at the given positions.
double angular_momentum(const GranularSystem& system, const std::vector<double>& x, const std::vector<double>& y,
                        const GranularState& s) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += system.mass[i] *
           (x[i] * s.velocity_y[i] - y[i] * s.velocity_x[i] + system.radius[i] * system.radius[i] / 2 * s.spin[i]);
  return sum;
}

// sum r_n |d| (1 - cos phi) / 2h over the contacts of two disks, phi the angle by which the line of centres
// turned since the last step, |d| its length then.
double gain_of_turning_normals(const GranularSystem& system, const GranularStep<2>& step) {
  double sum = 0;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const StepContact& c = step.problem.geometry[k];
    if (c.b >= system.grains()) continue;
    const double length = system.radius[at(c.a)] + system.radius[at(c.b)] + c.gap, h = step.problem.h;
    const GrainVelocity<2>&a = step.problem.start[at(c.a)], &b = step.problem.start[at(c.b)];
    const double dx = length * c.normal[0] - h * (b.x - a.x), dy = length * c.normal[1] - h * (b.y - a.y);
    sum += step.contacts[k].impulse.n * (std::hypot(dx, dy) - c.normal[0] * dx - c.normal[1] * dy) / (2 * h);
  }
  return sum;
}

// What contacts with one coefficient e in both directions take at least: with w = v + e v^- where they close
// (w = v where they part), r.w <= 0 and W r = v - v^-, the dissipation -r.(v + v^-)/2 is at least
//     (1 - e)/(1 + e) r.W r/2 - e/(1 + e) sum r_n max(0, v_n^-),
// the sum over contacts that parted and are pressed together by others.
double least_dissipation(const GranularStep<2>& step, double e) {
  double work = 0, pressed = 0;
  for (const GrainContact<2>& c : step.contacts) {
    const LocalVector<2> before = relative_velocity(c, step.problem.start);
    const LocalVector<2> after = relative_velocity(c, step.velocities);
    work += c.impulse.n * (after.n - before.n) + c.impulse.t * (after.t - before.t);
    pressed += c.impulse.n * std::max(0.0, before.n);
  }
  return (1 - e) / (1 + e) * work / 2 - e / (1 + e) * pressed;
}

}  // namespace

TEST_CASE("no gravity, no boundary: energy only falls, by what friction and impacts take, and momentum stays") {
  // Unequal coefficients have no bound: with friction Newton's law may gain energy there (Kane's paradox).
  struct Contact {
    double friction, restitution, tangential;
  };
  for (const Contact& contact : {Contact{0, 0, 0},
                                 {0.4, 0, 0},
                                 {1, 0, 0},
                                 {0, 0.5, 0},
                                 {0.4, 0.5, 0},
                                 {1, 0.5, 0},
                                 {0.4, 0.5, 0.5},
                                 {1, 0.5, 0.5}}) {
    const double friction = contact.friction, restitution = contact.restitution;
    const double tangential = contact.tangential;
    INFO("friction = ", friction, ", restitution = ", restitution, ", tangential = ", tangential);
    const bool bounded = friction == 0 || restitution == tangential;
    Dynamics dynamics = tight();
    dynamics.solver.tolerance = 1e-9;
    dynamics.solver.maximum_iterations = 5000;
    dynamics.interaction.friction = friction;
    dynamics.interaction.restitution = restitution;
    dynamics.interaction.tangential_restitution = tangential;
    dynamics.time.gravity = {0, 0};
    dynamics.time.penetration_correction = 0;
    Simulation simulation = shaken_lattice(6, 6, dynamics);
    const auto momentum = [&](const std::vector<double>& v) {
      double sum = 0;
      for (const double one : v) sum += one;
      return sum;
    };
    const double px = momentum(simulation.state.velocity_x), py = momentum(simulation.state.velocity_y);
    double energy = total_energy(energy_of(simulation.system, simulation.state, dynamics.time));
    const double scale = energy;
    for (int k = 0; k < 25; ++k) {
      const GranularStep<2> solved = solve_step(simulation);
      const double least = least_dissipation(solved, restitution);
      const StepReport report = take_step(simulation, solved);
      REQUIRE(report.residual.relative_natural_map() < 1e-4);
      CHECK(std::abs(report.energy.numerical) < 1e-13 * scale);
      CHECK(report.energy.boundary_work == 0);
      CHECK(total_energy(report.energy) - energy ==
            doctest::Approx(-report.energy.dissipation).epsilon(1e-10).scale(1e-3));
      if (bounded) CHECK(report.energy.dissipation > least - 1e-7 * scale);
      if (restitution == 0) CHECK(report.energy.dissipation > -1e-7 * scale);
      energy = total_energy(report.energy);
      CHECK(std::abs(momentum(simulation.state.velocity_x) - px) < 1e-12);
      CHECK(std::abs(momentum(simulation.state.velocity_y) - py) < 1e-12);
    }
    CHECK(energy < 0.8 * scale);
  }
}

TEST_CASE("default settings: correcting overlaps brings no energy into a box at rest") {
  // An overlap d is pushed out at d/h, which does the work r d/h: none where steps are solved to rounding.
  for (const Index seed : {1, 2, 3}) {
    CAPTURE(seed);
    Dynamics dynamics = tight();
    REQUIRE(dynamics.time.penetration_correction == 1);
    dynamics.solver.warm_start = true;
    dynamics.solver.tolerance = 1e-11;
    Simulation simulation = box_of_grains(12, dynamics, {1, 1}, seed);  // the deposit stands by friction
    const double start = total_energy(energy_of(simulation.system, simulation.state, dynamics.time));
    double energy = start;
    for (int k = 0; k < 100; ++k) {
      const StepReport report = advance(simulation);
      CHECK(report.overlap.maximum < 1e-12);
      CHECK(report.energy.boundary_work == 0);
      CHECK(report.energy.dissipation > -1e-12 * start);
      CHECK(total_energy(report.energy) < energy + 1e-12 * start);
      energy = total_energy(report.energy);
    }
    CHECK(energy == doctest::Approx(start).epsilon(1e-11));
  }
}

TEST_CASE("default settings: a falling heap without friction gains at most what the turning of normals gives") {
  // dE = r (v + v^-)/2 with v_n = -gap/h, and gap >= h v^-_n where normals keep their directions: no gain. As
  // the line of centres d turns by phi in a step, gap lags behind h v^-_n by |d| (1 - cos phi).
  Dynamics dynamics = tight();
  dynamics.interaction.law = "frictionless";
  dynamics.solver.warm_start = true;
  dynamics.solver.tolerance = 1e-11;
  Simulation simulation = box_of_grains(30, dynamics);
  const double start = total_energy(energy_of(simulation.system, simulation.state, dynamics.time));
  double energy = start;
  for (int k = 0; k < 100; ++k) {
    const GranularStep<2> step = solve_step(simulation);
    REQUIRE(step.report.status == SolverStatus::converged);
    const double allowed = gain_of_turning_normals(simulation.system, step);
    const StepReport report = take_step(simulation, step);
    CHECK(report.overlap.maximum < 1e-11);
    const double change = total_energy(report.energy) - energy;
    CHECK(change < allowed + 1e-12 * start);
    // Set in motion, nothing has met or parted yet: all contacts of the step before are still closed.
    if (k == 1) CHECK(change == doctest::Approx(allowed).epsilon(1e-5));
    energy += change;
  }
  CHECK(energy < start);
}

TEST_CASE("angular momentum at q_m changes by r_t times the gap of each contact, and by nothing else") {
  Dynamics dynamics = without_gravity({}, 0.005);
  dynamics.solver.maximum_iterations = 50;  // it holds for any impulses
  Simulation simulation = shaken_lattice(6, 5, dynamics);
  for (int k = 0; k < 10; ++k) {
    std::vector<double> x = simulation.state.x, y = simulation.state.y;
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += dynamics.time.step / 2 * simulation.state.velocity_x[i];
      y[i] += dynamics.time.step / 2 * simulation.state.velocity_y[i];
    }
    const double before = angular_momentum(simulation.system, x, y, simulation.state);
    const GranularStep<2> step = solve_step(simulation);
    double expected = 0;
    for (std::size_t c = 0; c < step.contacts.size(); ++c)
      expected += step.contacts[c].impulse.t * step.problem.geometry[c].gap;
    take_step(simulation, step);
    CHECK(std::abs(angular_momentum(simulation.system, x, y, simulation.state) - before - expected) < 1e-11);
  }
}

TEST_CASE("a box with moving walls: work put in, dissipation and energy balance to rounding at theta = 1/2") {
  Dynamics dynamics = swept({wall("paddle", {0, 5}, {0, 0}, moving({0.3, 0, -0.2}, {0, 0}))});
  dynamics.solver.maximum_iterations = 60;  // the balance holds for any impulses, converged or not
  dynamics.solver.warm_start = true;
  Simulation simulation = box_of_grains(60, dynamics);
  const StepEnergy start = energy_of(simulation.system, simulation.state, dynamics.time);
  double work = 0, dissipation = 0, scale = 0;
  StepReport report;
  for (int k = 0; k < 200; ++k) {
    report = take_step(simulation, solve_step(simulation));
    work += report.energy.boundary_work;
    dissipation += report.energy.dissipation;
    scale = std::max(scale, std::abs(total_energy(report.energy)));
    CHECK(std::abs(report.energy.numerical) < 1e-11 * scale);
  }
  CHECK(work > 1);
  CHECK(total_energy(report.energy) - total_energy(start) == doctest::Approx(work - dissipation).epsilon(1e-9));
}

TEST_CASE("work of a boundary: a wall that lifts a column puts in its weight times the height") {
  Dynamics dynamics = tight({wall("lift", {0, 0}, {1, 0}, moving({0, 0.5, 0}))});
  Simulation simulation =
      simulation_of({{.y = 0.5, .mass = 2, .velocity_y = 0.5}, {.y = 1.5, .mass = 3, .velocity_y = 0.5}}, dynamics);
  double work = 0, heat = 0;
  for (int k = 0; k < 100; ++k) {
    const StepReport report = advance(simulation);
    work += report.energy.boundary_work;
    heat += report.energy.dissipation;
  }
  CHECK(work == doctest::Approx(5 * g * 0.5 * 0.5).epsilon(1e-10));
  CHECK(std::abs(heat) < 1e-9);
  CHECK(simulation.state.y[1] == doctest::Approx(1.5 + 0.25).epsilon(1e-12));
}

TEST_CASE("without gravity and at rest, boundaries at rest do no work and nothing moves") {
  Dynamics dynamics = without_gravity({}, 0.005);
  Simulation simulation = box_of_grains(50, dynamics);
  const GranularState before = simulation.state;
  const StepReport report = take_step(simulation, solve_step(simulation));
  CHECK(report.energy.boundary_work == 0);
  CHECK(largest_speed(solve_step(simulation).velocities, 50) < 1e-9);
  for (std::size_t i = 0; i < before.x.size(); ++i) CHECK(std::abs(simulation.state.x[i] - before.x[i]) < 1e-11);
}

TEST_CASE("numerical energy of free fall is -(theta - 1/2) m g^2 h^2 a step") {
  for (const double theta : {0.5, 0.7, 1.0}) {
    Dynamics dynamics = tight();
    dynamics.time.theta = theta;
    Simulation simulation = simulation_of({{.y = 100, .mass = 3, .velocity_x = 1, .spin = 2}}, dynamics);
    for (int k = 0; k < 4; ++k) {
      const StepReport report = advance(simulation);
      CHECK(std::abs(report.energy.numerical + (theta - 0.5) * 3 * g * g * 0.005 * 0.005) < 1e-11);
      CHECK(report.energy.dissipation == 0);
    }
    // x(t): exact at theta = 1/2, behind or ahead by (theta - 1/2) g h t otherwise.
    const double t = 0.02;
    CHECK(simulation.state.y[0] == doctest::Approx(100 - g * t * t / 2 - (theta - 0.5) * g * 0.005 * t).epsilon(1e-14));
    CHECK(simulation.state.angle[0] == doctest::Approx(2 * t).epsilon(1e-14));
  }
}

TEST_CASE("turning the whole scene turns its motion") {
  const double turn = 0.77, c = std::cos(turn), s = std::sin(turn);
  Dynamics dynamics = swept();
  dynamics.solver.criterion = "none";
  dynamics.solver.order = "natural";  // the curve of the interleaved order turns with the scene
  dynamics.solver.maximum_iterations = 50;
  Simulation upright = box_of_grains(25, dynamics);
  Simulation turned = upright;
  turned.dynamics.time.gravity = {g * s, -g * c};
  for (std::size_t i = 0; i < upright.state.x.size(); ++i) {
    turned.state.x[i] = c * upright.state.x[i] - s * upright.state.y[i];
    turned.state.y[i] = s * upright.state.x[i] + c * upright.state.y[i];
  }
  for (Wall& one : turned.system.walls) {
    one.point = {c * one.point[0] - s * one.point[1], s * one.point[0] + c * one.point[1]};
    one.normal = {c * one.normal[0] - s * one.normal[1], s * one.normal[0] + c * one.normal[1]};
  }
  for (int k = 0; k < 6; ++k) {
    take_step(upright, solve_step(upright));
    take_step(turned, solve_step(turned));
  }
  for (std::size_t i = 0; i < upright.state.x.size(); ++i) {
    const double vx = upright.state.velocity_x[i], vy = upright.state.velocity_y[i];
    CHECK(std::abs(turned.state.velocity_x[i] - (c * vx - s * vy)) < 1e-8);
    CHECK(std::abs(turned.state.velocity_y[i] - (s * vx + c * vy)) < 1e-8);
    CHECK(std::abs(turned.state.spin[i] - upright.state.spin[i]) < 1e-7);
  }
}

TEST_CASE("a uniform velocity of everything changes nothing but itself") {
  Dynamics dynamics = swept();
  dynamics.solver.maximum_iterations = 30;
  dynamics.solver.criterion = "none";
  dynamics.solver.order = "natural";  // the curve of the interleaved order turns with the scene
  Simulation still = shaken_lattice(5, 5, dynamics, {2, 2});
  still.dynamics.solver.algorithm = "generic";
  Simulation carried = still;
  for (double& v : carried.state.velocity_x) v += 3;
  const GranularStep<2> a = solve_step(still), b = solve_step(carried);
  REQUIRE(a.contacts.size() == b.contacts.size());
  for (std::size_t k = 0; k < a.contacts.size(); ++k)
    CHECK(std::abs(a.contacts[k].impulse.n - b.contacts[k].impulse.n) < 1e-11);
}
