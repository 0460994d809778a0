// SPDX-License-Identifier: GPL-3.0-or-later
// One disk and walls: closed forms of mechanics. The scheme is exact for constant accelerations in velocity.
#include "../support/granular.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// A disk of radius r that touches a slope falling to the right at `angle`, friction mu.
Simulation on_slope(double angle, double mu, double radius, double mass) {
  Dynamics dynamics = tight({wall("slope", {0, 0}, {std::cos(angle), -std::sin(angle)})});
  dynamics.interaction.friction = mu;
  dynamics.time.step = 0.002;
  return simulation_of({{.x = radius * std::sin(angle), .y = radius * std::cos(angle), .radius = radius, .mass = mass}},
                       dynamics);
}

}  // namespace

TEST_CASE("incline: a disk rolls at 2/3 g sin where tan <= 3 mu, slides at g (sin - mu cos) where not") {
  const double radius = 0.25, mass = 3;
  for (const double angle : {0.1, 0.5, 0.9}) {
    CAPTURE(angle);
    const double limit = std::tan(angle) / 3;
    for (const double share : {0.5, 0.99, 1.01, 3.0}) {
      CAPTURE(share);
      const double mu = share * limit;
      Simulation simulation = on_slope(angle, mu, radius, mass);
      const Index steps = 100;
      advance(simulation, steps);
      const double t = 100 * 0.002;
      const bool rolls = share > 1;
      const double acceleration = rolls ? 2.0 / 3 * g * std::sin(angle) : g * (std::sin(angle) - mu * std::cos(angle));
      // I alpha = R x friction, I = m R^2 / 2, clockwise: rolling a / R; sliding 2 mu g cos / R.
      const double spin = rolls ? acceleration / radius : 2 * mu * g * std::cos(angle) / radius;
      const GranularState& s = simulation.state;
      CHECK(s.velocity_x[0] == doctest::Approx(acceleration * t * std::cos(angle)).epsilon(1e-11));
      CHECK(s.velocity_y[0] == doctest::Approx(-acceleration * t * std::sin(angle)).epsilon(1e-11));
      CHECK(s.spin[0] == doctest::Approx(-spin * t).epsilon(1e-11));
      // theta = 1/2 integrates a constant acceleration exactly: a t^2 / 2 along the slope.
      const double along =
          (s.x[0] - radius * std::sin(angle)) * std::cos(angle) - (s.y[0] - radius * std::cos(angle)) * std::sin(angle);
      CHECK(along == doctest::Approx(acceleration * t * t / 2).epsilon(1e-11));
      CHECK(s.angle[0] == doctest::Approx(-spin * t * t / 2).epsilon(1e-11));
      const LocalVector<2> r = impulse_between(s, 0, 1);
      CHECK(r.n == doctest::Approx(mass * g * std::cos(angle) * 0.002).epsilon(1e-11));
      const double friction = rolls ? mass * g * std::sin(angle) / 3 : mu * mass * g * std::cos(angle);
      CHECK(std::abs(r.t) == doctest::Approx(friction * 0.002).epsilon(1e-11));
    }
  }
}

TEST_CASE("incline: tilting gravity instead of the wall is the same motion") {
  const double angle = 0.4;
  Simulation tilted_wall = on_slope(angle, 0.1, 0.5, 1);
  Dynamics dynamics = tilted_wall.dynamics;
  dynamics.time.gravity = {g * std::sin(angle), -g * std::cos(angle)};
  dynamics.boundaries = {floor_wall()};
  Simulation tilted_gravity = simulation_of({{.y = 0.5}}, dynamics);
  advance(tilted_wall, 50);
  advance(tilted_gravity, 50);
  CHECK(std::hypot(tilted_wall.state.velocity_x[0], tilted_wall.state.velocity_y[0]) ==
        doctest::Approx(tilted_gravity.state.velocity_x[0]).epsilon(1e-12));
  CHECK(std::abs(tilted_gravity.state.velocity_y[0]) < 1e-12);
  CHECK(tilted_wall.state.spin[0] == doctest::Approx(tilted_gravity.state.spin[0]).epsilon(1e-12));
}

TEST_CASE("a disk thrown along a floor slides until v = 2/3 v0, then rolls for ever") {
  // v = v0 - mu g t, rim = 2 mu g t: equal at t = v0 / (3 mu g) after v0 t - mu g t^2 / 2 = 5 v0^2 / (18 mu g).
  const double v0 = 3, mu = 0.25, radius = 0.4;
  const double t_roll = v0 / (3 * mu * g);
  Dynamics dynamics = tight({floor_wall()});
  dynamics.interaction.friction = mu;
  const Index slide_steps = 200;
  dynamics.time.step = t_roll / static_cast<double>(slide_steps);
  Simulation simulation = simulation_of({{.y = radius, .radius = radius, .mass = 2, .velocity_x = v0}}, dynamics);
  advance(simulation, slide_steps / 2);
  CHECK(simulation.state.velocity_x[0] == doctest::Approx(v0 - mu * g * t_roll / 2).epsilon(1e-12));
  CHECK(simulation.state.spin[0] == doctest::Approx(-2 * mu * g * t_roll / 2 / radius).epsilon(1e-12));
  advance(simulation, slide_steps / 2);
  CHECK(simulation.state.velocity_x[0] == doctest::Approx(2.0 / 3 * v0).epsilon(1e-12));
  CHECK(simulation.state.x[0] == doctest::Approx(5 * v0 * v0 / (18 * mu * g)).epsilon(1e-12));
  const StepReport last = advance(simulation, 300);
  CHECK(simulation.state.velocity_x[0] == doctest::Approx(2.0 / 3 * v0).epsilon(1e-12));
  CHECK(simulation.state.spin[0] == doctest::Approx(-2.0 / 3 * v0 / radius).epsilon(1e-12));
  CHECK(std::abs(last.energy.dissipation) < 1e-12);
  // One third of the kinetic energy went: m v0^2 / 2 - (m/2 + m/4) (2/3 v0)^2 = m v0^2 / 6.
  CHECK(last.energy.kinetic == doctest::Approx(2 * v0 * v0 / 3).epsilon(1e-12));
}

TEST_CASE("with backspin 2 v0 / R a disk slides to a stop after v0^2 / (2 mu g), and stays") {
  // v = v0 - mu g t and rim = 2 v0 - 2 mu g t vanish together: slip never changes its sign before.
  const double v0 = 2, mu = 0.4, radius = 0.2;
  Dynamics dynamics = tight({floor_wall()});
  dynamics.interaction.friction = mu;
  dynamics.time.step = v0 / (mu * g) / 400;
  Simulation simulation =
      simulation_of({{.y = radius, .radius = radius, .velocity_x = v0, .spin = 2 * v0 / radius}}, dynamics);
  advance(simulation, 200);
  CHECK(simulation.state.velocity_x[0] == doctest::Approx(v0 / 2).epsilon(1e-12));
  CHECK(simulation.state.spin[0] == doctest::Approx(v0 / radius).epsilon(1e-12));
  advance(simulation, 200);
  CHECK(simulation.state.x[0] == doctest::Approx(v0 * v0 / (2 * mu * g)).epsilon(1e-12));
  advance(simulation, 100);
  CHECK(std::abs(simulation.state.velocity_x[0]) < 1e-12);
  CHECK(std::abs(simulation.state.spin[0]) < 1e-11);
  CHECK(simulation.state.x[0] == doctest::Approx(v0 * v0 / (2 * mu * g)).epsilon(1e-12));
}

TEST_CASE("conveyor: a disk put on a moving belt ends up rolling at a third of its speed") {
  // m V = J and m/2 rim = J until slip U - V - rim = 0: V = U / 3.
  const double belt = 1.5, mu = 0.2;
  Dynamics dynamics = tight({wall("belt", {0, 0}, {1, 0}, moving({belt, 0, 0}))});
  dynamics.interaction.friction = mu;
  Simulation simulation = simulation_of({{.y = 0.5, .mass = 4}}, dynamics);
  advance(simulation, 10);
  CHECK(simulation.state.velocity_x[0] == doctest::Approx(mu * g * 0.05).epsilon(1e-12));
  double work = 0, heat = 0;
  for (int k = 0; k < 200; ++k) {
    const StepReport report = advance(simulation);
    work += report.energy.boundary_work;
    heat += report.energy.dissipation;
    CHECK(std::abs(report.energy.numerical) < 1e-12);
  }
  CHECK(simulation.state.velocity_x[0] == doctest::Approx(belt / 3).epsilon(1e-12));
  CHECK(simulation.state.spin[0] == doctest::Approx(2 * belt / 3 / 0.5).epsilon(1e-12));
  // From V1 to U/3 the belt gives momentum m (U/3 - V1), that is work U times it.
  CHECK(work == doctest::Approx(belt * 4 * (belt / 3 - mu * g * 0.05)).epsilon(1e-11));
  const double kinetic_gain = (4 / 2.0 * (belt * belt / 9) + 4 / 4.0 * (4 * belt * belt / 9)) -
                              (4 / 2.0 + 4 / 4.0 * 4) * std::pow(mu * g * 0.05, 2);
  CHECK(heat == doctest::Approx(work - kinetic_gain).epsilon(1e-11));
}

TEST_CASE("bounce: speeds fall by e, heights by e^2, within the error of the step") {
  const double height = 1, radius = 0.3;
  for (const double e : {0.5, 0.9, 1.0}) {
    CAPTURE(e);
    Dynamics dynamics = tight({floor_wall()});
    dynamics.interaction.restitution = e;
    dynamics.time.step = 1e-4;
    Simulation simulation = simulation_of({{.y = radius + height, .radius = radius}}, dynamics);
    const double impact = std::sqrt(2 * g * height);
    for (int bounce = 1; bounce <= 3; ++bounce) {
      double before = 0;
      Index guard = 0;
      while (simulation.state.velocity_y[0] <= 0 && ++guard < 20'000) {
        before = simulation.state.velocity_y[0];
        advance(simulation);
      }
      REQUIRE(guard < 20'000);
      CHECK(simulation.state.velocity_y[0] == doctest::Approx(-e * before).epsilon(1e-13));
      // Each bounce is felt within a step of its instant: an error of g h of speed on either side.
      const double speed = std::pow(e, bounce) * impact;
      CHECK(std::abs(simulation.state.velocity_y[0] - speed) < 2 * bounce * g * 1e-4);
      double highest = 0;
      guard = 0;
      while (simulation.state.velocity_y[0] > 0 && ++guard < 20'000) {
        highest = std::max(highest, simulation.state.y[0]);
        advance(simulation);
      }
      REQUIRE(guard < 20'000);
      CHECK(std::abs(highest - radius - std::pow(e, 2 * bounce) * height) < 3 * bounce * impact * 1e-4);
    }
  }
}

TEST_CASE("inelastic impact: the disk stops on the floor without overlap and stays") {
  Dynamics dynamics = tight({floor_wall()});
  dynamics.time.step = 0.005;
  for (const double drop : {0.013, 0.2, 1.7}) {
    Simulation simulation = simulation_of({{.y = 0.5 + drop}}, dynamics);
    double lowest_middle = 1;  // of q_m, where the scheme promises no overlap
    for (int k = 0; k < 300; ++k) {
      const double before = simulation.state.velocity_y[0];
      lowest_middle = std::min(lowest_middle, simulation.state.y[0] + 0.0025 * before);
      advance(simulation);
    }
    CHECK(lowest_middle > 0.5 - 1e-12);
    CHECK(simulation.state.velocity_y[0] == doctest::Approx(0).epsilon(1e-12));
    // The half step at V^- that lands on q_m: at rest the centre is where q_m was.
    CHECK(std::abs(simulation.state.y[0] - 0.5) < 1e-12);
    CHECK(impulse_between(simulation.state, 0, 1).n == doctest::Approx(g * 0.005).epsilon(1e-12));
  }
}

TEST_CASE("cohesion: a disk hangs from a ceiling iff its weight is at most the cohesive force") {
  for (const double share : {0.2, 0.999, 1.001, 2.0}) {
    CAPTURE(share);
    const double mass = 1.5, h = 0.002;
    Dynamics dynamics = tight({wall("ceiling", {1, 0}, {0, 0})});
    dynamics.interaction.law = "cohesive";
    dynamics.interaction.cohesion = mass * g / share;
    dynamics.time.step = h;
    Simulation simulation = simulation_of({{.y = -0.5, .mass = mass}}, dynamics);
    advance(simulation, 3);
    if (share < 1) {
      CHECK(std::abs(simulation.state.velocity_y[0]) < 1e-13);
      CHECK(impulse_between(simulation.state, 0, 1).n == doctest::Approx(-mass * g * h).epsilon(1e-12));
    } else {
      // As long as it touches, to a thousandth of its radius, the bond pulls with all it has.
      CHECK(simulation.state.velocity_y[0] == doctest::Approx(-(1 - 1 / share) * g * 3 * h).epsilon(1e-10));
    }
  }
}

TEST_CASE("cohesion: bodies that do not touch do not attract each other, whatever alert and restitution say") {
  for (const double gap : {0.02, 0.002, 0.0})
    for (const double alert : {0.0, 0.01, 0.05, 0.2})
      for (const double restitution : {0.0, 0.5}) {
        INFO("gap = ", gap, ", alert = ", alert, ", restitution = ", restitution);
        Dynamics dynamics = tight();
        dynamics.interaction.law = "cohesive";
        dynamics.interaction.cohesion = 10;
        dynamics.interaction.restitution = restitution;
        dynamics.time.gravity = {0, 0};
        dynamics.time.alert = alert;
        Simulation simulation = simulation_of({{.x = 0}, {.x = 1 + gap}}, dynamics);
        advance(simulation, 5);
        CHECK(simulation.state.velocity_x[0] == 0);
        CHECK(impulse_between(simulation.state, 0, 1).n == 0);
        // Pulled apart by less than the cohesive force: they hold where they touch alone.
        simulation.dynamics.time.gravity = {0, -1};
        simulation.state.velocity_x[1] = 0.04;
        advance(simulation);
        // Without restitution the gap that opened up to q_m, 0.02 h, is closed again.
        const double held = gap > 0 ? 0 : (0.04 + (restitution > 0 ? 0 : 0.02)) / 2;
        CHECK(impulse_between(simulation.state, 0, 1).n == doctest::Approx(-held).epsilon(1e-12));
        CHECK(simulation.state.velocity_x[0] == doctest::Approx(held).epsilon(1e-12));
      }
}

TEST_CASE("cohesion: a touching contact holds until it is pulled apart, then for good") {
  // A disk that hangs from a ceiling at half the cohesive force; gravity doubles, and more, for a while.
  for (const double restitution : {0.0, 0.5}) {
    CAPTURE(restitution);
    Dynamics dynamics = tight({wall("ceiling", {1, 0}, {0, 0})});
    dynamics.interaction.law = "cohesive";
    dynamics.interaction.cohesion = 2 * g;
    dynamics.interaction.restitution = restitution;
    Simulation simulation = simulation_of({{.y = -0.5}}, dynamics);
    advance(simulation, 200);
    CHECK(std::abs(simulation.state.y[0] + 0.5) < 1e-12);
    simulation.dynamics.time.gravity = {0, -3 * g};
    advance(simulation, 4);
    CHECK(-simulation.state.y[0] - 0.5 > touching_gap * 0.5);
    const double before = simulation.state.velocity_y[0];
    simulation.dynamics.time.gravity = {0, -g};
    advance(simulation, 3);
    CHECK(simulation.state.velocity_y[0] == doctest::Approx(before - 3 * g * 0.005).epsilon(1e-12));
  }
}

TEST_CASE("linear viscous law: a disk sinks into the floor at the speed epsilon m g h") {
  // r = -v / epsilon and at constant speed r = m g h; before: v_{k+1} = (v_k - g h) / (1 + 1 / (epsilon m)).
  const double epsilon = 0.7, mass = 2, h = 0.001;
  Dynamics dynamics = tight({floor_wall()});
  dynamics.interaction.law = "linear_viscous";
  SUBCASE("epsilon in 1/kg") { dynamics.interaction.epsilon = epsilon; }
  SUBCASE("epsilon as a multiple of W = 1/m") { dynamics.interaction.epsilon = {epsilon * mass, true}; }
  dynamics.time.step = h;
  dynamics.time.penetration_correction = 0;
  Simulation simulation = simulation_of({{.y = 0.5, .mass = mass, .velocity_x = 0.3, .spin = 0.8}}, dynamics);
  double vy = 0, vx = 0.3, rim = 0.4;
  for (int k = 0; k < 60; ++k) {
    advance(simulation);
    vy = (vy - g * h) / (1 + 1 / (epsilon * mass));
    // Slip s = vx + rim decays by 1 / (1 + 3 / (epsilon m)); it is shared 1 : 2 by vx and rim.
    const double slip = vx + rim, lost = slip * (1 - 1 / (1 + 3 / (epsilon * mass)));
    vx -= lost / 3;
    rim -= 2 * lost / 3;
    CHECK(simulation.state.velocity_y[0] == doctest::Approx(vy).epsilon(1e-11));
    CHECK(simulation.state.velocity_x[0] == doctest::Approx(vx).epsilon(1e-11));
    CHECK(simulation.state.spin[0] == doctest::Approx(rim / 0.5).epsilon(1e-11));
  }
  CHECK(simulation.state.velocity_y[0] == doctest::Approx(-epsilon * mass * g * h).epsilon(1e-9));
  CHECK(solve_step(simulation).report.scale == doctest::Approx(1 / mass).epsilon(1e-15));
}
