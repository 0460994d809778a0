// SPDX-License-Identifier: GPL-3.0-or-later
// Circles in the plane, and cylinders that move across their axis, have ends or are free: closed forms and balances.
#include "../support/spheres.hpp"
#include "mechanics/path.hpp"

#include <doctest/doctest.h>

#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

BoundarySpec circle(std::array<double, 2> middle, double radius, CylinderSide side = CylinderSide::inside,
                    Motion motion = {}) {
  BoundarySpec spec = wall("circle", middle, middle, std::move(motion));
  spec.shape = BoundaryShape::cylinder;
  spec.radius = radius;
  spec.side = side;
  return spec;
}

// A full cylinder with ends at -half and half on the z axis.
BoundarySpec rod(double radius, double half, Motion motion = {}) {
  BoundarySpec spec = cylinder("rod", -half * Vector3::UnitZ(), half * Vector3::UnitZ(), radius, CylinderSide::outside);
  spec.ends = true;
  spec.motion = std::move(motion);
  return spec;
}

Dynamics in_flight(const BoundarySpec& boundary, Components<double> gravity, double step = 1e-3) {
  Dynamics dynamics = tight({boundary});
  dynamics.time.gravity = gravity;
  dynamics.time.step = step;
  return dynamics;
}

void set_free(BoundarySpec& boundary, double mass, const Vector3& inertia, std::array<bool, 6> directions) {
  FreeBody& body = boundary.body.emplace();
  body.directions = directions;
  body.mass = mass;
  Vector3::Map(body.inertia.data()) = inertia;
}

}  // namespace

TEST_CASE("circle: a disk rests at the bottom of a hollow one, and on top of a full one, with its weight") {
  for (const CylinderSide side : {CylinderSide::inside, CylinderSide::outside}) {
    const bool inside = side == CylinderSide::inside;
    CAPTURE(inside);
    const double y = inside ? 4 - 2 + 0.5 : 4 + 2 + 0.5;
    Simulation simulation = simulation_of({{.x = 3, .y = y, .mass = 7}}, tight({circle({3, 4}, 2, side)}));
    const double h = simulation.dynamics.time.step;
    advance(simulation, 20);
    CHECK(impulse_between(simulation.state, 0, 1).n == doctest::Approx(7 * g * h).epsilon(1e-12));
    CHECK(simulation.state.y[0] == doctest::Approx(y).epsilon(1e-13));
    const StepProblem<2> problem = solve_step<2>(simulation).problem;
    REQUIRE(problem.geometry.size() == 1);
    CHECK(problem.geometry[0].point[0] == doctest::Approx(3));
    CHECK(problem.geometry[0].point[1] == doctest::Approx(inside ? 2 : 6).epsilon(1e-13));
    CHECK(problem.geometry[0].normal[1] == doctest::Approx(-1).epsilon(1e-13));
  }
}

TEST_CASE("circle: a disk that rolls in a drum is a pendulum of 3/2 its length") {
  const double radius = 0.1, drum = 1, angle = 1e-3,
               period = 2 * std::numbers::pi * std::sqrt(1.5 * (drum - radius) / g);
  const auto error = [&](Index steps) {
    Dynamics dynamics = tight({circle({1, 2}, drum)});
    dynamics.time.step = period / static_cast<double>(steps);
    dynamics.interaction.friction = 10;
    Simulation simulation = simulation_of(
        {{.x = 1 + (drum - radius) * std::sin(angle), .y = 2 - (drum - radius) * std::cos(angle), .radius = radius}},
        dynamics);
    advance(simulation, steps);
    return std::hypot((simulation.state.x[0] - 1) / (drum - radius) / angle - 1,
                      simulation.state.velocity_x[0] / (drum - radius) / angle * period / (2 * std::numbers::pi));
  };
  const double coarse = error(500), fine = error(1000);
  CHECK(fine < 1e-4);
  CHECK(coarse / fine == doctest::Approx(4).epsilon(0.1));  // of second order, as it sticks
}

TEST_CASE("circle: a drum that turns spins a disk on the spot, and carries one that does not spin until it slides") {
  const double radius = 0.1, drum = 1, omega = 0.2, mu = 0.4;
  Dynamics dynamics = tight({circle({1, 2}, drum, CylinderSide::inside, moving({0, 0, omega}, {1, 2}))});
  dynamics.interaction.friction = mu;
  Simulation rolls =
      simulation_of({{.x = 1, .y = 2 - drum + radius, .radius = radius, .spin = omega * drum / radius}}, dynamics);
  advance(rolls, 400);
  CHECK(rolls.state.spin[0] == doctest::Approx(omega * drum / radius).epsilon(1e-12));
  CHECK(rolls.state.x[0] == doctest::Approx(1).epsilon(1e-12));
  // A disk that keeps its angle goes with the drum up to g sin t = mu (g cos t + v^2 / (R - r)).
  BoundarySpec slider = driven_grains("slider", 0, 0);
  slider.motion.centre = {1, 2 - drum + radius, 0};
  set_free(slider, 3, Vector3::Zero(), {true, true, false, false, false, false});
  dynamics.boundaries.push_back(slider);
  const double h = dynamics.time.step = 1e-3, arm = drum - radius;
  Simulation slides = simulation_of({{.x = 1, .y = 2 - drum + radius, .radius = radius}}, dynamics);
  slides.state.body_velocities[1] = {.x = omega * drum};
  double found = 0, speed = omega * drum;
  for (int k = 0; k < 3000 && found == 0; ++k) {
    advance(slides);
    const LocalVector<2> impulse = impulse_between(slides.state, 0, 1);
    if (std::abs(impulse.t) >= mu * impulse.n * (1 - 1e-9))
      found = std::atan2(slides.state.x[0] - 1, 2 - slides.state.y[0]);
    else
      CHECK(std::hypot(slides.state.body_velocities[1].x, slides.state.body_velocities[1].y) ==
            doctest::Approx(speed).epsilon(1e-3));
  }
  const auto excess = [&](double t) { return g * std::sin(t) - mu * (g * std::cos(t) + speed * speed / arm); };
  CHECK(found > 0.3);
  CHECK(excess(found - 3 * h * speed / arm) < 0);
  CHECK(excess(found + 3 * h * speed / arm) > 0);
}

TEST_CASE("circle: a free one and the disks in it keep their momenta, and without friction their energy") {
  for (const double friction : {0.0, 0.6}) {
    CAPTURE(friction);
    BoundarySpec ring = circle({0.1, 0.2}, 2);
    ring.motion.centre = {0.1, 0.2, 0};
    ring.motion.initial = RigidVelocity{.x = 0.3, .spin = friction};
    set_free(ring, 5, {0, 0, 20}, {true, true, false, false, false, true});
    Dynamics dynamics = in_flight(ring, {0, 0}, 1e-3);
    dynamics.interaction.friction = friction;
    dynamics.interaction.restitution = 1 - friction;
    dynamics.interaction.signorini = Signorini::velocity;
    Simulation simulation = simulation_of(
        {{.x = -0.8, .radius = 0.4, .velocity_x = 2, .velocity_y = 1, .spin = 3}, {.x = 0.6, .velocity_y = -1.5}},
        dynamics);
    const auto momenta = [&] {
      const GranularState& s = simulation.state;
      const RigidVelocity& v = s.body_velocities[0];
      Eigen::Vector4d sum(5 * v.x, 5 * v.y, 20 * v.spin + 5 * (s.poses[0].x * v.y - s.poses[0].y * v.x), 0);
      sum[3] = 2.5 * (v.x * v.x + v.y * v.y) + 10 * v.spin * v.spin;
      for (std::size_t i = 0; i < 2; ++i) {
        const double inertia = simulation.system.radius[i] * simulation.system.radius[i] / 2, vx = s.velocity_x[i],
                     vy = s.velocity_y[i];
        sum += Eigen::Vector4d(vx, vy, inertia * s.spin[i] + s.x[i] * vy - s.y[i] * vx,
                               (vx * vx + vy * vy + inertia * s.spin[i] * s.spin[i]) / 2);
      }
      return sum;
    };
    const Eigen::Vector4d before = momenta();
    Index hits = 0;
    for (int k = 0; k < 5000; ++k) {
      advance(simulation);
      hits += count(simulation.state.impulses);
    }
    const Eigen::Vector4d after = momenta();
    CHECK(hits >= 4);
    CHECK((after - before).head<2>().norm() < 1e-11);
    CHECK(after[2] == doctest::Approx(before[2]).epsilon(friction == 0 ? 1e-11 : 5e-3));  // gaps, times friction
    if (friction == 0)
      CHECK(after[3] == doctest::Approx(before[3]).epsilon(1e-11));
    else
      CHECK(after[3] < 0.99 * before[3]);
  }
}

TEST_CASE("circle: in a periodic cell grains meet the nearest image of a full one") {
  Packing packing;
  packing.x = {4.9};
  packing.y = {0.62};
  packing.radius = {0.5};
  packing.mass = {1};
  const Dynamics dynamics = tight({circle({0.2, -1}, 1, CylinderSide::outside)});
  const GranularScene start = scene(packing, dynamics, {.x = 5});
  const double dx = 0.3, dy = 1.62, distance = std::hypot(dx, dy);
  const WallPoint point = nearest_point(start.system, start.system.walls[0], {4.9, 0.62, 0});
  CHECK(point.height == doctest::Approx(distance - 1).epsilon(1e-12));
  CHECK(point.normal[0] == doctest::Approx(-dx / distance).epsilon(1e-12));
  CHECK(point.foot[0] == doctest::Approx(5.2 - dx / distance).epsilon(1e-12));
}

TEST_CASE("rod: the nearest point is on its surface, on an end or on the edge") {
  const Simulation scene = simulation_of({Ball{.centre = {9, 9, 9}}}, tight({rod(2, 3)}));
  const auto check_point = [&](const Place& p, const Vector3& foot, const Vector3& normal, double height) {
    const WallPoint found = nearest_point(scene.system.walls[0], p);
    CHECK((Vector3::Map(found.foot.data()) - foot).norm() < 1e-14);
    CHECK((Vector3::Map(found.normal.data()) - normal).norm() < 1e-14);
    CHECK(found.height == doctest::Approx(height).epsilon(1e-14));
  };
  check_point({0, 5, -2.9}, {0, 2, -2.9}, {0, 1, 0}, 3);
  check_point({0, 1, -4}, {0, 1, -3}, {0, 0, -1}, 1);
  check_point({0, 0, 4}, {0, 0, 3}, {0, 0, 1}, 1);
  check_point({5, 0, 7}, {2, 0, 3}, {0.6, 0, 0.8}, 5);
  check_point({1, 0, 2.9}, {1, 0, 3}, {0, 0, 1}, -0.1);  // within
  check_point({1.9, 0, 0}, {2, 0, 0}, {1, 0, 0}, -0.1);
}

TEST_CASE("rod: a sphere rests on its end, and falls off its edge") {
  const Ball on_end{.centre = {0.3, 0.1, 1.5}, .mass = 3};
  Simulation rests = simulation_of({on_end}, tight({rod(0.5, 1)}));
  advance_in_space(rests, 20);
  CHECK(impulse_on_second(rests.state, 0, 1)[2] == doctest::Approx(-3 * g * rests.dynamics.time.step).epsilon(1e-12));
  CHECK((centre_of_ball(rests.state, 0) - on_end.centre).norm() < 1e-13);
  // Like a pendulum upside down about the edge, without friction: from rest at t with height r cos t.
  const double start = 0.2, end = 0.5;
  const Dynamics dynamics = in_flight(rod(0.5, 1), {0, 0, -g}, 1e-4);
  Simulation falls =
      simulation_of({Ball{.centre = {0.5 + 0.5 * std::sin(start), 0, 1 + 0.5 * std::cos(start)}, .mass = 3}}, dynamics);
  falls.dynamics.interaction.friction = 0;
  double angle = start;
  while (angle < end && falls.state.step < 20'000) {
    advance_in_space(falls);
    angle = std::atan2(falls.state.x[0] - 0.5, falls.state.z[0] - 1);
  }
  CHECK(angle >= end);
  CHECK(velocity_of_ball(falls.state, 0).squaredNorm() ==
        doctest::Approx(2 * g * 0.5 * (std::cos(start) - std::cos(angle))).epsilon(2e-3));
}

TEST_CASE("rod: no sphere passes through it in a step") {
  Dynamics dynamics = in_flight(rod(0.2, 1), {0, 0, 0}, 0.1);
  dynamics.interaction.restitution = 1;
  dynamics.interaction.signorini = Signorini::velocity;
  int refused = 0;
  for (const double x : {-0.75, -1.0, -1.5, -1.9, -2.4}) {
    CAPTURE(x);
    Simulation simulation = simulation_of({Ball{.centre = {x, 0, 0.5}, .velocity = {25, 0, 0}}}, dynamics);
    simulation.dynamics.time.steps = 3;
    const std::string refusal = refusal_of(simulation);
    if (refusal.empty())
      CHECK(simulation.state.velocity_x[0] == doctest::Approx(-25));
    else
      CHECK(refusal.find("dynamics.step") != std::string::npos);
    refused += !refusal.empty();
  }
  CHECK(refused >= 2);
}

TEST_CASE("cylinder: moved across its axis, or turned about a point of it, it pushes a sphere along the normal") {
  constexpr double v = 0.7, a = 0.6, radius = 2;
  const Vector3 normal(std::cos(a), std::sin(a), 0), centre = (radius + 0.5) * normal + Vector3(0, 0, 3);
  for (const bool ends : {false, true})
    for (const bool turns : {false, true}) {
      INFO("ends = ", ends, ", turns = ", turns);
      BoundarySpec spec =
          rod(radius, 5, turns ? moving_in_space({0, 0, 0}, {0, v, 0}) : moving_in_space({v, 0, 0}, {0, 0, 0}));
      spec.ends = ends;
      Dynamics dynamics = in_flight(spec, {0, 0, 0}, 1e-6);
      dynamics.interaction.friction = 0;
      dynamics.time.maximum_push_speed = 0;
      Simulation simulation = simulation_of({Ball{.centre = centre, .mass = 3}}, dynamics);
      const StepReport report = advance_in_space(simulation);
      // A point of the surface at height z moves with v + (v_x, 0, 0), v_x = omega z.
      const double speed = (turns ? 3 * v : v) * normal[0];
      CHECK((velocity_of_ball(simulation.state, 0) - speed * normal).norm() < 1e-5);
      CHECK(report.energy.boundary_work == doctest::Approx(3 * speed * speed).epsilon(1e-5));
      CHECK(report.energy.dissipation == doctest::Approx(1.5 * speed * speed).epsilon(1e-5));
      CHECK(std::abs(report.energy.numerical) < 1e-12);
      if (turns) continue;
      advance_in_space(simulation, 200);
      CHECK(simulation.state.impulses.empty());  // they part
    }
}

TEST_CASE("cylinder: a free one that a sphere hits beside its middle gets the impulse of a rigid body") {
  constexpr double v = 2, e = 0.5, mass = 5, across = 4, arm = 1.5;
  for (const bool inside : {false, true}) {
    CAPTURE(inside);
    BoundarySpec spec = rod(inside ? 3 : 1, 3);
    if (inside) spec.ends = false, spec.side = CylinderSide::inside;
    set_free(spec, mass, {across, across, 6}, {true, true, true, true, true, true});
    Dynamics dynamics = in_flight(spec, {0, 0, 0}, 1e-6);
    dynamics.interaction.friction = 0;
    dynamics.interaction.restitution = e;
    dynamics.interaction.signorini = Signorini::velocity;
    Simulation simulation =
        simulation_of({Ball{.centre = {inside ? 2.5 : -1.5, 0, arm}, .mass = 2, .velocity = {v, 0, 0}}}, dynamics);
    advance_in_space(simulation, 2);
    const double impulse = (1 + e) * v / (1 / 2.0 + 1 / mass + arm * arm / across);
    const RigidVelocity& found = simulation.state.body_velocities[0];
    CHECK(found.x == doctest::Approx(impulse / mass).epsilon(1e-5));
    CHECK(found.spin_y == doctest::Approx(arm * impulse / across).epsilon(1e-5));
    CHECK(velocity_of_ball(simulation.state, 0)[0] == doctest::Approx(v - impulse / 2).epsilon(1e-5));
  }
}
