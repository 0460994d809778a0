// SPDX-License-Identifier: GPL-3.0-or-later
// Packings at rest: reactions and friction bounds of elementary statics.
#include "../support/granular.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("column of disks between walls: every reaction is the weight above it") {
  for (const std::string law : {"coulomb", "frictionless"})
    for (const std::string order : {"natural", "reverse", "random", "coloured", "interleaved"}) {
      INFO("law = ", law, ", order = ", order);
      Dynamics dynamics = tight({floor_wall(), wall("left", {-0.5, 1}, {-0.5, 0}), wall("right", {0.5, 0}, {0.5, 1})});
      dynamics.interaction.law = law;
      dynamics.solver.order = order;
      std::vector<Grain> grains;
      const Index n = 8;
      for (Index i = 0; i < n; ++i)
        grains.push_back({.y = 0.5 + static_cast<double>(i), .mass = 1 + 0.3 * static_cast<double>(i)});
      Simulation simulation = simulation_of(grains, dynamics);
      for (int step = 0; step < 3; ++step) {
        advance(simulation);
        double above = 0;
        for (Index i = n - 1; i >= 0; --i) {
          above += (1 + 0.3 * static_cast<double>(i)) * g * 0.005;
          const LocalVector<2> r =
              i == 0 ? impulse_between(simulation.state, 0, n) : impulse_between(simulation.state, i - 1, i);
          CHECK(r.n == doctest::Approx(above).epsilon(1e-9));
          CHECK(std::abs(r.t) < 1e-9);
          CHECK(std::abs(simulation.state.velocity_y[at(i)]) < 1e-9);
          CHECK(std::abs(impulse_between(simulation.state, i, n + 1).n) < 1e-9);
        }
      }
    }
}

TEST_CASE("a disk in a frictionless wedge: both reactions by the triangle of forces") {
  // The disk touches walls at 30 (left) and 60 degrees from the horizontal: N = W sin 60 / sin 90 and W sin 30.
  const double a = std::numbers::pi / 6, b = std::numbers::pi / 3;
  Dynamics dynamics = tight();
  dynamics.interaction.law = "frictionless";
  dynamics.boundaries = {wall("left", {-std::cos(a), std::sin(a)}, {0, 0}),
                         wall("right", {0, 0}, {std::cos(b), std::sin(b)})};
  // Normals (sin a, cos a) and (-sin b, cos b); distance 0.5 from both: with a + b = 90 degrees the centre is
  // the sum of both normals times 0.5.
  Simulation simulation = simulation_of(
      {{.x = 0.5 * (std::sin(a) - std::sin(b)), .y = 0.5 * (std::cos(a) + std::cos(b)), .mass = 3}}, dynamics);
  advance(simulation, 5);
  CHECK(impulse_between(simulation.state, 0, 1).n == doctest::Approx(3 * g * 0.005 * std::sin(b)).epsilon(1e-11));
  CHECK(impulse_between(simulation.state, 0, 2).n == doctest::Approx(3 * g * 0.005 * std::sin(a)).epsilon(1e-11));
  CHECK(std::abs(simulation.state.velocity_y[0]) < 1e-12);
}

TEST_CASE("three-disk pile stands iff mu >= tan 15 deg between grains and >= tan 15 deg / 3 at the floor") {
  // Moments about the centre of a lower disk: the same friction T at both its contacts. Its balance along the
  // floor: N sin 30 = T (1 + cos 30), so T / N = tan 15 deg; on top 2 (N cos 30 + T sin 30) = W gives N =
  // W/2; the floor carries 3 W / 2. The two lower disks do not press on each other.
  const double grain_bound = std::tan(std::numbers::pi / 12), floor_bound = grain_bound / 3;
  const auto fastest_after = [](double grain_friction, double floor_friction) {
    Dynamics dynamics = tight({floor_wall()});
    dynamics.solver.tolerance = 1e-11;
    dynamics.interaction.friction = grain_friction;
    dynamics.interaction.boundary_friction = floor_friction;
    Simulation simulation =
        simulation_of({{.x = -0.5, .y = 0.5}, {.x = 0.5, .y = 0.5}, {.x = 0, .y = 0.5 + std::sqrt(0.75)}}, dynamics);
    advance(simulation, 20);
    return std::hypot(simulation.state.velocity_x[0], simulation.state.velocity_y[2]);
  };
  CHECK(fastest_after(1.05 * grain_bound, 1.05 * floor_bound) < 1e-9);
  CHECK(fastest_after(5, 5) < 1e-9);
  CHECK(fastest_after(0.95 * grain_bound, 5) > 1e-4);
  CHECK(fastest_after(5, 0.95 * floor_bound) > 1e-4);
}

TEST_CASE("total vertical reaction of floor and walls equals the weight of a settled box") {
  Dynamics dynamics = tight();
  dynamics.solver.tolerance = 1e-6;
  dynamics.solver.maximum_iterations = 500;
  dynamics.solver.warm_start = true;
  Simulation simulation = box_of_grains(60, dynamics);
  double weight = 0;
  for (const double m : simulation.system.mass) weight += m * g;
  StepReport last;
  constexpr int steps = 400, last_steps = 100;
  double upward = 0, momentum_before = 0, momentum = 0, mean = 0;
  for (int step = 0; step < steps; ++step) {
    momentum_before = momentum;
    last = take_step(simulation, solve_step(simulation));  // the balance holds, converged or not
    momentum = upward = 0;
    for (std::size_t i = 0; i < simulation.system.mass.size(); ++i)
      momentum += simulation.system.mass[i] * simulation.state.velocity_y[i];
    const Index n = simulation.system.grains();
    // n points from the grain into the boundary and the grain feels -r: floor n = (0, -1), walls (-1, 0), (1, 0).
    for (const RememberedImpulse& one : simulation.state.impulses) {
      if (one.b == n) upward += one.impulse[0];
      if (one.b == n + 1) upward += one.impulse[1];  // left: t = (0, -1)
      if (one.b == n + 2) upward -= one.impulse[1];
    }
    if (step >= steps - last_steps) mean += upward / last_steps;
    // Balance of momentum, every step: floor and walls are all that acts besides gravity.
    CHECK(momentum - momentum_before == doctest::Approx(upward - weight * 0.005).epsilon(1e-9).scale(weight * 0.005));
  }
  // Settled: slow (mm/s on average), and over half a second the reaction is the weight.
  CHECK(last.energy.kinetic < weight / g / 2 * 1e-5);
  CHECK(mean == doctest::Approx(weight * 0.005).epsilon(1e-3));
}
