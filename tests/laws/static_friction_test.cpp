// SPDX-License-Identifier: GPL-3.0-or-later
// A static friction: contacts that did not slide in the last step hold by it, others by the dynamic one.
#include "../support/granular.hpp"
#include "../support/spheres.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr double at_rest = 0.6, sliding = 0.4, time_step = 0.002;

// A block of two grains that does not turn, with that velocity along a floor under gravity that is tilted along x.
Simulation block(Index dimension, double angle, double velocity, Choice<StepAlgorithm> algorithm, bool warm_start) {
  Dynamics dynamics = tight();
  dynamics.interaction.friction = sliding;
  dynamics.interaction.static_friction = at_rest;
  dynamics.time.step = time_step;
  dynamics.solver.algorithm = algorithm;
  dynamics.solver.warm_start = warm_start;
  BoundarySpec spec = driven_grains("block", 0, 1);
  spec.dimension = dimension;
  spec.motion.initial = RigidVelocity{.x = velocity};
  spec.body.emplace();
  spec.body->mass = 3;
  const double along = g * std::sin(angle), down = -g * std::cos(angle);
  if (dimension == 2) {
    spec.motion.centre = {0.5, 0.5, 0};
    spec.body->directions = {true, true};
    dynamics.time.gravity = {along, down};
    dynamics.boundaries = {floor_wall(), spec};
    return simulation_of(std::vector<Grain>{{.x = 0, .y = 0.5}, {.x = 1, .y = 0.5}}, dynamics);
  }
  spec.motion.centre = {0.5, 0, 0.5};
  spec.body->directions = {true, true, true};
  dynamics.time.gravity = {along, 0, down};
  dynamics.boundaries = {plane("floor", Vector3::Zero(), Vector3::UnitZ()), spec};
  return simulation_of({{.centre = Vector3(0, 0, 0.5)}, {.centre = Vector3(1, 0, 0.5)}}, dynamics);
}

double speed_after(Simulation& simulation, Index steps) {
  simulation.system.dimension == 2 ? advance(simulation, steps) : advance_in_space(simulation, steps);
  return simulation.state.body_velocities[1].x;
}

}  // namespace

TEST_CASE("static friction: a block at rest stays up to its angle, one that slides speeds up beyond the dynamic one") {
  for (const Index dimension : {2, 3})
    for (const StepAlgorithm algorithm : {StepAlgorithm::nlgs, StepAlgorithm::automatic, StepAlgorithm::newton})
      for (const bool warm_start : {true, false}) {
        INFO("dimension = ", dimension, ", algorithm = ", to_string(algorithm), ", warm_start = ", warm_start);
        const auto along = [](double angle, double friction) {
          return time_step * g * (std::sin(angle) - friction * std::cos(angle));
        };
        const double between = std::atan(0.5), above = std::atan(0.7), below = std::atan(0.3);
        Simulation rests = block(dimension, between, 0, algorithm, warm_start);
        CHECK(std::abs(speed_after(rests, 20)) < 1e-9);
        // The first step has no earlier one in which it slid.
        Simulation slides = block(dimension, between, 1, algorithm, warm_start);
        CHECK(speed_after(slides, 20) ==
              doctest::Approx(1 + along(between, at_rest) + 19 * along(between, sliding)).epsilon(1e-8));
        Simulation starts = block(dimension, above, 0, algorithm, warm_start);
        CHECK(speed_after(starts, 20) ==
              doctest::Approx(along(above, at_rest) + 19 * along(above, sliding)).epsilon(1e-8));
        Simulation stops = block(dimension, below, 0.01, algorithm, warm_start);
        CHECK(std::abs(speed_after(stops, 20)) < 1e-9);
        // At rest again, it holds by the static friction.
        auto& gravity = stops.dynamics.time.gravity;
        gravity = rests.dynamics.time.gravity;
        CHECK(std::abs(speed_after(stops, 20)) < 1e-9);
      }
}
