// SPDX-License-Identifier: GPL-3.0-or-later
// Overlaps that a packing begins with vanish: how fast they are pushed apart, and what that adds to the energy.
#include "../support/granular.hpp"
#include <nscdd/packing/generator.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// A hexagonal lattice on a floor, so dense that neighbours overlap by a part of their radius, as imported ones may.
Simulation pressed_lattice(double overlap, Dynamics dynamics) {
  const double radius = 0.01, nearer = 1 - overlap / 2;
  Packing packing = generate(Generator{HexagonalLattice{.columns = 12, .rows = 12, .radius = radius}});
  double lowest = infinity;
  for (std::size_t i = 0; i < packing.x.size(); ++i) {
    packing.x[i] *= nearer;
    packing.y[i] *= nearer;
    lowest = std::min(lowest, packing.y[i]);
  }
  packing.mass.assign(packing.x.size(), 0.3);
  dynamics.boundaries = {wall("floor", {0, lowest - nearer * radius}, {1, lowest - nearer * radius})};
  GranularScene made = scene(packing, dynamics);
  return {made.system, made.state, dynamics, GridPartitioner{{2, 1}}};
}

// Weight times height of a packing, J.
double weight_times_height(const Simulation& simulation) {
  const GranularState& state = simulation.state;
  const auto [low, high] = std::minmax_element(state.y.begin(), state.y.end());
  double mass = 0;
  for (const double one : simulation.system.mass) mass += one;
  return mass * g * (*high - *low);
}

Dynamics loose() {
  Dynamics dynamics = swept();
  dynamics.solver.tolerance = 1e-6;
  dynamics.solver.maximum_iterations = 5000;
  dynamics.solver.warm_start = true;
  dynamics.time.step = 1e-3;
  return dynamics;
}

}  // namespace

TEST_CASE("two bodies that overlap part at the natural speed, or slower where that is enough") {
  for (const double h : {1e-4, 1e-3, 5e-3})
    for (const double overlap : {1e-6, 0.035})
      for (const double speed : {0.0, 0.3}) {
        INFO("h = ", h, ", overlap = ", overlap, ", speed = ", speed);
        Dynamics dynamics = tight();
        dynamics.interaction.friction = 0;
        dynamics.time.step = h;
        // A row of driven disks far away sets the scale of speeds without touching them.
        const auto parting = [&](Dynamics asked) {
          asked.boundaries = {row_of_disks("far", {50, 50}, {51, 50}, 0.5, moving({-speed, 0, 0}))};
          Simulation simulation = simulation_of({{.x = 0}, {.x = 1 - overlap}}, asked);
          advance(simulation);
          return simulation.state.velocity_x[1] - simulation.state.velocity_x[0];
        };
        const double natural = 0.02 * (std::sqrt(g * 0.5) + speed);
        CHECK(parting(dynamics) == doctest::Approx(std::min(overlap / h, natural)).epsilon(1e-9));
        dynamics.time.maximum_push_speed = 0.007;
        CHECK(parting(dynamics) == doctest::Approx(std::min(overlap / h, 0.007)).epsilon(1e-9));
        dynamics.time.maximum_push_speed = 1e9;
        CHECK(parting(dynamics) == doctest::Approx(overlap / h).epsilon(1e-9));
        dynamics.time.penetration_correction = 0.3;
        CHECK(parting(dynamics) == doctest::Approx(0.3 * overlap / h).epsilon(1e-9));
      }
}

TEST_CASE("a packing with overlaps of 7 % of a radius gains next to nothing, and they vanish") {
  const double overlap = 0.07;
  Simulation simulation = pressed_lattice(overlap, loose());
  const double scale = weight_times_height(simulation), layers = 12;
  double gained = 0, left = 0;
  for (int k = 0; k < 400; ++k) {
    const StepReport report = take_step(simulation, solve_step(simulation));
    const double gain = std::max(0.0, -report.energy.dissipation);
    CHECK(gain < 0.02 * 0.02 * layers / 6 * scale);  // twice that of a column
    gained += gain;
    if (k >= 300) left = std::max(left, report.overlap.relative);
    if (k == 0) CHECK(report.overlap.relative == doctest::Approx(overlap).epsilon(1e-9));
  }
  CHECK(gained < 0.03 * scale);
  CHECK(left < 1e-3);
  // Without a bound one step adds some times its weight times its height.
  Dynamics unbounded = loose();
  unbounded.time.maximum_push_speed = 1e9;
  simulation = pressed_lattice(overlap, unbounded);
  CHECK(-take_step(simulation, solve_step(simulation)).energy.dissipation > 5 * scale);
}

TEST_CASE("a column of overlapping disks at rest is pushed apart: speeds of pushes add up along it") {
  for (const int disks : {2, 6, 30, 100})
    for (const double h : {1e-4, 1e-3}) {
      INFO("disks = ", disks, ", h = ", h);
      const double radius = 0.1, distance = 2 * radius * (1 - 0.07 / 2);
      Packing column;
      for (int k = 0; k < disks; ++k) {
        column.x.push_back(0);
        column.y.push_back(k * distance);
        column.radius.push_back(radius);
        column.mass.push_back(1);
      }
      Dynamics dynamics = loose();
      dynamics.solver.maximum_iterations = 100'000;
      dynamics.time.step = h;
      dynamics.boundaries = {wall("floor", {0, radius - distance}, {1, radius - distance})};
      const GranularScene made = scene(column, dynamics);
      const GranularStep<2> step = solve_step({made.system, made.state, dynamics, GridPartitioner{}});
      CHECK(step.report.status == SolverStatus::converged);
      CHECK(!step.energy_exploded);
      // The k-th disk leaves at k pushes.
      const double push = 0.02 * std::sqrt(g * radius);
      CHECK(step.velocities[at(Index{disks} - 1)].y == doctest::Approx(disks * push).epsilon(1e-2));
    }
}

TEST_CASE("without gravity overlaps of bodies at rest stay, and do not grow") {
  Dynamics dynamics = without_gravity({}, 0.005);
  Simulation simulation = simulation_of({{.x = 0}, {.x = 0.93}}, dynamics);
  advance(simulation, 5);
  CHECK(simulation.state.x == std::vector<double>{0, 0.93});
}
