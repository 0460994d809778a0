// SPDX-License-Identifier: GPL-3.0-or-later
// Boundaries that oscillate, and Signorini's condition on the velocity, against closed forms.
#include "../support/granular.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// A plate with v_y = amplitude sin(omega t): it rises from rest.
Motion shaken(double amplitude, double omega) {
  Motion motion;
  motion.oscillations = {{{.y = amplitude}, omega, -std::numbers::pi / 2}};
  return motion;
}

Simulation on_plate(const Motion& motion, double step, BoundaryInstant instant, double height = 0.5) {
  Dynamics dynamics = tight({wall("plate", {0, 0}, {1, 0}, motion)});
  dynamics.time.step = step;
  dynamics.time.boundary_instant = instant;
  return simulation_of({{.y = height}}, dynamics);
}

}  // namespace

TEST_CASE("oscillation: amplitude cos(omega t + phase) min(1, ramp + growth t), added to the entries") {
  Motion motion;
  motion.time = {0, 2};
  motion.velocity = {{.x = 1}, {.x = 3}};
  motion.oscillations = {{{.x = 2, .spin = -4}, 3, 0.5, 0.25, 0.5}, {{.y = 5}, 0, 0}};
  for (const double t : {0.0, 0.5, 1.0, 1.5, 2.0, 7.0}) {
    CAPTURE(t);
    const double wave = std::cos(3 * t + 0.5) * std::min(1.0, 0.25 + 0.5 * t);
    CHECK(motion.at(t).x == doctest::Approx(std::min(1 + t, 3.0) + 2 * wave).epsilon(1e-14));
    CHECK(motion.at(t).spin == doctest::Approx(-4 * wave).epsilon(1e-14));
    CHECK(motion.at(t).y == 5);
  }
}

TEST_CASE("a disk rides on a plate that shakes at less than g: its height is (A/omega) (1 - cos omega t)") {
  constexpr double amplitude = 0.4, omega = 20, step = 1e-3;  // A omega = 8 m/s^2
  for (const BoundaryInstant instant : {BoundaryInstant::middle, BoundaryInstant::end}) {
    const bool at_end = instant == BoundaryInstant::end;
    Simulation simulation = on_plate(shaken(amplitude, omega), step, instant);
    double before = 0;
    for (Index k = 1; k <= 400; ++k) {
      const StepReport report = advance(simulation);
      CAPTURE(k);
      // q_m of the plate moves by h v(t + h) from one step to the next: exact at the end, else to the order of h.
      const double t = static_cast<double>(k) * step, v = simulation.state.velocity_y[0];
      CHECK(
          v ==
          doctest::Approx(amplitude * std::sin(omega * t)).scale(1).epsilon(at_end ? 1e-11 : amplitude * omega * step));
      CHECK(std::abs(simulation.state.y[0] - 0.5 - amplitude / omega * (1 - std::cos(omega * t))) <
            amplitude * omega * step * (at_end ? step : 1));
      // Newton's law of the disk, and the work of the plate.
      CHECK(impulse_between(simulation.state, 0, 1).n == doctest::Approx(g * step + v - before).epsilon(1e-9));
      if (at_end)
        CHECK(report.energy.boundary_work ==
              doctest::Approx((g * step + v - before) * (v + before) / 2).scale(1).epsilon(1e-11));
      before = v;
    }
  }
}

TEST_CASE("a plate that falls faster than g leaves the disk: from there on it flies") {
  constexpr double amplitude = 2, omega = 20, step = 2e-4;  // A omega = 40 m/s^2
  Simulation simulation = on_plate(shaken(amplitude, omega), step, BoundaryInstant::end);
  simulation.dynamics.solver.tolerance = 1e-9;
  const double leaves = std::acos(-g / (amplitude * omega)) / omega;  // A omega cos(omega t) = -g
  const double speed = amplitude * std::sin(omega * leaves);
  const double height = amplitude / omega * (1 - std::cos(omega * leaves));
  for (const double after : {0.05, 0.1}) {
    while (simulation.state.time < leaves + after) advance(simulation);
    const double t = simulation.state.time - leaves;
    CHECK(simulation.state.y[0] - 0.5 == doctest::Approx(height + speed * t - g * t * t / 2).epsilon(1e-3));
    CHECK(simulation.state.velocity_y[0] == doctest::Approx(speed - g * t).scale(1).epsilon(1e-3));
  }
}

TEST_CASE("a plate that turns about a point carries its disks on (1 - theta) v(t) + theta v(t + h)") {
  Motion motion;
  motion.oscillations = {{{.spin = 0.3}, 5, 0}};
  for (const double theta : {0.5, 0.7}) {
    Dynamics dynamics = tight({driven_grains("arm", 1, 1, motion), floor_wall()});
    dynamics.time.step = 0.01;
    dynamics.time.theta = theta;
    dynamics.time.boundary_instant = BoundaryInstant::end;
    Simulation simulation = simulation_of({{.y = 0.5}, {.x = 3, .y = 4}}, dynamics);
    advance(simulation, 20);
    double angle = 0;
    for (Index k = 0; k < 20; ++k) {
      const double t = 0.01 * static_cast<double>(k);
      angle += 0.01 * ((1 - theta) * motion.at(t).spin + theta * motion.at(t + 0.01).spin);
    }
    CHECK(simulation.state.poses[0].angle == doctest::Approx(angle).epsilon(1e-13));
    CHECK(simulation.state.angle[1] == doctest::Approx(angle).epsilon(1e-13));
    CHECK(simulation.state.x[1] == doctest::Approx(3 * std::cos(angle) - 4 * std::sin(angle)).epsilon(1e-13));
    CHECK(simulation.state.spin[1] == doctest::Approx(motion.at(0.2).spin).epsilon(1e-13));
  }
}

TEST_CASE("condition on the velocity: without restitution a disk stops where it has gone through the floor") {
  // Contacts are found at q_m = delta - V h (k + 1/2): the first k with q_m <= 0 stops the disk there.
  constexpr double step = 1e-3, delta = 0.0021;
  Dynamics dynamics = without_gravity({floor_wall()}, step);
  for (const bool on_velocity : {true, false}) {
    dynamics.interaction.signorini = on_velocity ? Signorini::velocity : Signorini::gap;
    Simulation simulation = simulation_of({{.y = 0.5 + delta, .velocity_y = -1}}, dynamics);
    advance(simulation, 2);
    if (on_velocity) CHECK(simulation.state.velocity_y[0] == -1);
    advance(simulation, 10);
    CHECK(std::abs(simulation.state.velocity_y[0]) < 1e-13);
    CHECK(simulation.state.y[0] - 0.5 == doctest::Approx(on_velocity ? -0.0004 : 0).scale(1).epsilon(1e-13));
  }
}

TEST_CASE("contacts of the first step are found where the initial velocity of a boundary leads") {
  // A plate that rises at 1 m/s, a gap of a quarter of a step's way below the disk: in half a step they touch, but not
  // if the plate is at rest before time 0.
  constexpr double step = 1e-3;
  Motion motion = moving({.y = 1});
  for (const bool at_rest : {true, false}) {
    if (at_rest)
      motion.initial = RigidVelocity{};
    else
      motion.initial.reset();
    Simulation simulation = on_plate(motion, step, BoundaryInstant::end, 0.5 + step / 4);
    simulation.dynamics.interaction.signorini = Signorini::velocity;
    simulation.dynamics.time.gravity = {0, 0};
    advance(simulation);
    CHECK(simulation.state.velocity_y[0] == doctest::Approx(at_rest ? 0 : 1).scale(1).epsilon(1e-13));
    CHECK(simulation.state.poses[0].y == doctest::Approx(step).epsilon(1e-13));  // it moves by the motion alone
    advance(simulation);
    CHECK(simulation.state.velocity_y[0] == doctest::Approx(1).epsilon(1e-13));
  }
}
