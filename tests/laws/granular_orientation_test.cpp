// SPDX-License-Identifier: GPL-3.0-or-later
// Disks that a boundary drives round its foot: as parts of one rigid body they spin with it, with a fixed
// orientation they do not, and a grain rolling on them feels the difference. Their centres move at right angles to
// their arms where contacts are found.
#include "../support/granular.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr double wall_radius = 1.0, arm = 3.0, spin = 1e-3, duration = 1e-3;

// A grain at rest on top of a driven disk whose boundary turns about a foot an arm below. `shape`: the driven
// disk belongs to the boundary, or is a grain of the packing.
Simulation grain_on_driven_disk(BoundaryShape shape, Orientation orientation) {
  Dynamics dynamics = tight();
  dynamics.time.step = duration;
  dynamics.interaction.friction = 1;
  BoundarySpec spec;
  spec.name = "driven";
  spec.shape = shape;
  spec.from = {0, 0};
  spec.to = {10, 0};
  spec.radius = wall_radius;
  spec.spacing = 10;
  spec.first = spec.last = 1;
  spec.motion = moving({0, 0, spin}, {0, -arm});
  spec.orientation = orientation;
  dynamics.boundaries = {spec};
  std::vector<Grain> grains{{.y = wall_radius + 0.5, .radius = 0.5, .mass = 2}};
  if (shape == BoundaryShape::grains) grains.push_back({.radius = wall_radius});
  return simulation_of(grains, dynamics);
}

}  // namespace

TEST_CASE("a grain on a driven disk rolls as its surface moves: with its spin or, of fixed orientation, without") {
  for (const BoundaryShape shape : {BoundaryShape::disks, BoundaryShape::grains})
    for (const Orientation orientation : {Orientation::turning, Orientation::fixed}) {
      INFO("shape = ", to_string(shape), ", orientation = ", to_string(orientation));
      Simulation simulation = grain_on_driven_disk(shape, orientation);
      // The centre of the driven disk goes at -arm x spin; its top, which the grain touches, also by its own
      // spin. The grain, 1 : 2 heavier in translation than in its rim, sticks at once.
      const double surface = -spin * (arm + (orientation == Orientation::fixed ? 0 : wall_radius));
      for (const int steps : {1, 20}) {
        while (simulation.state.step < steps) advance(simulation);
        CAPTURE(steps);
        const double tolerance = steps == 1 ? 1e-4 : 1e-2;  // later the grain begins to roll off
        CHECK(simulation.state.velocity_x[0] == doctest::Approx(surface / 3).epsilon(tolerance));
        CHECK(simulation.state.spin[0] == doctest::Approx(2 * surface / 3 / 0.5).epsilon(tolerance));
      }
      const double angle = orientation == Orientation::fixed ? 0 : 20 * duration * spin;
      CHECK(simulation.state.angle[1] == doctest::Approx(angle).epsilon(1e-12));
      CHECK(simulation.state.spin[1] == (orientation == Orientation::fixed ? 0 : spin));
      // Its centre goes round the foot all the same.
      CHECK(simulation.state.x[1] == doctest::Approx(-arm * std::sin(20 * duration * spin)).epsilon(1e-12));
    }
}

TEST_CASE("a driven disk that turns about its foot does not push a frictionless disk that touches it along its arm") {
  for (const double theta : {0.5, 0.75, 1.0})
    for (const BoundaryInstant instant : {BoundaryInstant::middle, BoundaryInstant::end}) {
      INFO("theta = ", theta, ", instant = ", to_string(instant));
      Dynamics dynamics = without_gravity({}, 0.1);
      dynamics.time.theta = theta;
      dynamics.interaction.friction = 0;
      dynamics.time.boundary_instant = instant;
      BoundarySpec spec;
      spec.name = "driven";
      spec.shape = BoundaryShape::grains;
      spec.first = spec.last = 2;
      const double fast = 0.2, turn = (1 - theta) * dynamics.time.step * fast;  // rad/s, and rad up to q_m
      spec.motion = moving({0, 0, fast}, {0, -arm});
      dynamics.boundaries = {spec};
      // One disk touches at q_m along the arm; one is met by the driven disk at its full speed.
      const double along = arm + wall_radius + 0.5, aside = wall_radius + 0.5;
      const double c = std::cos(turn), s = std::sin(turn);
      Simulation simulation =
          simulation_of({{.x = -along * s, .y = along * c - arm, .radius = 0.5, .mass = 2},
                         {.x = -arm * s - aside * c, .y = arm * c - arm - aside * s, .radius = 0.5, .mass = 2},
                         {.radius = wall_radius}},
                        dynamics);
      advance(simulation);
      CHECK(std::hypot(simulation.state.velocity_x[0], simulation.state.velocity_y[0]) < 1e-13);
      CHECK(simulation.state.velocity_x[1] == doctest::Approx(-arm * fast * c).epsilon(1e-12));
      CHECK(simulation.state.velocity_y[1] == doctest::Approx(-arm * fast * s).epsilon(1e-12));
    }
}
