// SPDX-License-Identifier: GPL-3.0-or-later
// Few spheres, planes and cylinders: closed forms of mechanics. The scheme is exact for constant accelerations.
#include "../support/spheres.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

const Vector3 up(0, 0, 1);

// Any direction but the axes, so that no formula can do without one of its components.
Eigen::Quaterniond askew() { return Eigen::Quaterniond(0.8, 0.3, -0.4, 0.2).normalized(); }

double close(const Vector3& a, const Vector3& b) { return (a - b).norm() / std::max(1e-300, b.norm()); }

Dynamics on_plane(const Vector3& normal, double friction, double step) {
  Dynamics dynamics = tight({plane("floor", Vector3::Zero(), normal)});
  dynamics.interaction.friction = friction;
  dynamics.time.step = step;
  return dynamics;
}

}  // namespace

TEST_CASE("incline: a sphere rolls at 5/7 g sin where tan <= 7/2 mu, slides at g (sin - mu cos) where not") {
  const double radius = 0.25, mass = 3, step = 0.002, t = 100 * step;
  for (const double angle : {0.1, 0.5, 0.9})
    for (const double share : {0.5, 0.99, 1.01, 3.0}) {
      INFO("angle = ", angle, ", share = ", share);
      const double mu = share * 2 / 7 * std::tan(angle);
      const Vector3 side = Vector3(3, -4, 0) / 5;  // the slope falls along it
      const Vector3 normal = std::cos(angle) * up + std::sin(angle) * side;
      const Vector3 down = std::cos(angle) * side - std::sin(angle) * up;
      Simulation simulation =
          simulation_of({Ball{.centre = radius * normal, .radius = radius, .mass = mass}}, on_plane(normal, mu, step));
      const StepReport report = advance_in_space(simulation, 100);
      const bool rolls = share > 1;
      const double acceleration = rolls ? 5.0 / 7 * g * std::sin(angle) : g * (std::sin(angle) - mu * std::cos(angle));
      // I alpha = R x friction, I = 2 m R^2 / 5: rolling a / R; sliding 5/2 mu g cos / R.
      const double spin = rolls ? acceleration / radius : 2.5 * mu * g * std::cos(angle) / radius;
      const Vector3 axis = normal.cross(down);
      const GranularState& s = simulation.state;
      CHECK(close(velocity_of_ball(s, 0), acceleration * t * down) < 1e-11);
      CHECK(close(spin_of_ball(s, 0), spin * t * axis) < 1e-11);
      CHECK(close(centre_of_ball(s, 0), radius * normal + acceleration * t * t / 2 * down) < 1e-11);
      const Eigen::Quaterniond turned_by(Eigen::AngleAxisd(spin * t * t / 2, axis));
      CHECK(turn_of_ball(s, 0).angularDistance(turned_by) < 1e-7);  // an arc cosine near 1
      const double friction = rolls ? mass * g * std::sin(angle) * 2 / 7 : mu * mass * g * std::cos(angle);
      const Vector3 on_ball = -impulse_on_second(s, 0, 1);
      CHECK(close(on_ball, step * (mass * g * std::cos(angle) * normal - friction * down)) < 1e-11);
      CHECK(std::abs(report.energy.numerical) < 1e-12);
    }
}

TEST_CASE("a sphere that spins on a floor slips until it rolls at 2/7 of its rim; its spin about the normal stays") {
  const double radius = 0.2, mu = 0.1, step = 0.001;
  const Vector3 spin(6, -8, 5);
  Simulation simulation =
      simulation_of({Ball{.centre = radius * up, .radius = radius, .spin = spin}}, on_plane(up, mu, step));
  const Vector3 rim = radius * Vector3(spin[0], spin[1], 0).cross(up);  // how fast it would roll without slipping
  const double end_of_slip = 2.0 / 7 * rim.norm() / (mu * g);
  advance_in_space(simulation, static_cast<Index>(0.5 * end_of_slip / step));
  const double t = simulation.state.time;
  CHECK(close(velocity_of_ball(simulation.state, 0), mu * g * t * rim.normalized()) < 1e-9);
  advance_in_space(simulation, static_cast<Index>(end_of_slip / step));
  const GranularState& s = simulation.state;
  CHECK(close(velocity_of_ball(s, 0), 2.0 / 7 * rim) < 1e-9);
  CHECK(close(spin_of_ball(s, 0), Vector3(2.0 / 7 * spin[0], 2.0 / 7 * spin[1], spin[2])) < 1e-9);
}

TEST_CASE("a free sphere turns about its axis at constant speed, and its quaternion stays a unit") {
  Dynamics dynamics = tight();
  dynamics.time.step = 0.01;
  const Vector3 spin(30, -20, 50), velocity(1, 2, 3);
  Simulation simulation = simulation_of({Ball{.velocity = velocity, .spin = spin}}, dynamics);
  for (int k = 0; k < 20; ++k) {
    advance_in_space(simulation, 100);
    const GranularState& s = simulation.state;
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(spin.norm() * s.time, spin.normalized()));
    const Eigen::Quaterniond found = turn_of_ball(s, 0);
    CHECK(std::abs(found.norm() - 1) < 1e-15);
    CHECK((found * Vector3(1, 2, 3) - expected * Vector3(1, 2, 3)).norm() < 1e-10);
    CHECK(close(spin_of_ball(s, 0), spin) < 1e-14);
    CHECK(close(centre_of_ball(s, 0), s.time * velocity - s.time * s.time / 2 * g * up) < 1e-12);
  }
}

TEST_CASE("two spheres collide: restitution along the normal and across it, momentum and angular momentum stay") {
  const Eigen::Quaterniond q = askew();
  for (const double tangential : {0.0, 0.4})
    for (const double mu : {0.05, 100.0}) {
      INFO("tangential = ", tangential, ", mu = ", mu);
      Dynamics dynamics = tight();
      dynamics.time.gravity = {0, 0, 0};
      dynamics.time.step = 1e-3;
      dynamics.interaction.friction = mu;
      dynamics.interaction.restitution = 0.6;
      dynamics.interaction.tangential_restitution = tangential;
      const Vector3 n = q * Vector3(0, 0, 1);
      const Ball a{.centre = Vector3::Zero(),
                   .radius = 0.3,
                   .mass = 2,
                   .velocity = q * Vector3(1, 0.5, 3),
                   .spin = q * Vector3(1, -2, 4)};
      const Ball b{.centre = 0.8 * (1 - 1e-9) * n,
                   .radius = 0.5,
                   .mass = 5,
                   .velocity = q * Vector3(-0.5, 1, -1),
                   .spin = q * Vector3(-3, 1, 2)};
      const auto contact_velocity = [&](const Vector3& va, const Vector3& sa, const Vector3& vb, const Vector3& sb) {
        return Vector3(vb + sb.cross(-b.radius * n) - va - sa.cross(a.radius * n));
      };
      Dynamics at_once = dynamics;
      at_once.time.theta = 1;  // contacts are found where the spheres are
      Simulation simulation = simulation_of({a, b}, at_once);
      advance_in_space(simulation);
      const GranularState& s = simulation.state;
      const Vector3 before = contact_velocity(a.velocity, a.spin, b.velocity, b.spin);
      const Vector3 after =
          contact_velocity(velocity_of_ball(s, 0), spin_of_ball(s, 0), velocity_of_ball(s, 1), spin_of_ball(s, 1));
      const Vector3 before_t = before - before.dot(n) * n, after_t = after - after.dot(n) * n;
      CHECK(after.dot(n) == doctest::Approx(-0.6 * before.dot(n)));
      const double w = 1 / a.mass + 1 / b.mass;
      const double normal_impulse = 1.6 * std::abs(before.dot(n)) / w;
      if (mu > 1)
        CHECK((after_t + tangential * before_t).norm() < 1e-12);
      else
        CHECK(close(after_t, before_t - 3.5 * w * mu * normal_impulse * before_t.normalized()) < 1e-11);
      const Vector3 momentum = a.mass * a.velocity + b.mass * b.velocity;
      CHECK(close(a.mass * velocity_of_ball(s, 0) + b.mass * velocity_of_ball(s, 1), momentum) < 1e-13);
      const auto moment = [&](const Vector3& va, const Vector3& sa, const Vector3& vb, const Vector3& sb) {
        const double inertia_a = 0.4 * a.mass * a.radius * a.radius, inertia_b = 0.4 * b.mass * b.radius * b.radius;
        return Vector3(a.centre.cross(a.mass * va) + b.centre.cross(b.mass * vb) + inertia_a * sa + inertia_b * sb);
      };
      CHECK(close(moment(velocity_of_ball(s, 0), spin_of_ball(s, 0), velocity_of_ball(s, 1), spin_of_ball(s, 1)),
                  moment(a.velocity, a.spin, b.velocity, b.spin)) < 1e-8);  // the overlap is 1e-9
    }
}

TEST_CASE("a column of spheres carries its weight down") {
  Dynamics dynamics = on_plane(up, 0.3, 0.005);
  std::vector<Ball> balls;
  for (int k = 0; k < 6; ++k) balls.push_back({.centre = (0.5 + k) * up, .mass = 1.0 + k});
  Simulation simulation = simulation_of(balls, dynamics);
  advance_in_space(simulation, 3);
  double above = 0;
  for (int k = 5; k > 0; --k) {
    above += balls[static_cast<std::size_t>(k)].mass * g * 0.005;
    CHECK(close(impulse_on_second(simulation.state, k - 1, k), above * up) < 1e-9);
  }
  CHECK(close(impulse_on_second(simulation.state, 0, 6), -(above + balls[0].mass * g * 0.005) * up) < 1e-9);
}

TEST_CASE("a pyramid of four spheres stands by friction sin / (1 + cos) of its edges, and falls with less") {
  // Three spheres on a floor with small gaps between them, one on top. An edge from below to the top has the horizontal
  // part s and the vertical one c. A sphere below turns if friction at the floor and at the top differ, hence
  // F = N s / (1 + c) at both, and N c + F s = W / 3.
  const double radius = 0.5, gap = 0.01, step = 0.005;
  const double out = (2 * radius + gap) / std::sqrt(3.0), s = out / (2 * radius), c = std::sqrt(1 - s * s);
  const double needed = s / (1 + c);
  for (const double share : {0.98, 1.02}) {
    CAPTURE(share);
    Dynamics dynamics = on_plane(up, share * needed, step);
    dynamics.time.alert = 0.001;
    dynamics.interaction.boundary_friction = 1;
    std::vector<Ball> balls;
    for (int k = 0; k < 3; ++k) {
      const double angle = 0.3 + 2 * std::numbers::pi * k / 3;
      balls.push_back({.centre = Vector3(out * std::cos(angle), out * std::sin(angle), radius)});
    }
    balls.push_back({.centre = Vector3(0, 0, radius + 2 * radius * c)});
    Simulation simulation = simulation_of(balls, dynamics);
    advance_in_space(simulation, 20);
    const double fallen = radius + 2 * radius * c - simulation.state.z[3];
    if (share < 1) {
      CHECK(fallen > 1e-5);
      continue;
    }
    CHECK(std::abs(fallen) < 1e-9);
    const double normal = 9.81 * step / 3 / (c + needed * s);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 n = (balls[3].centre - balls[k].centre).normalized();
      const Vector3 p = impulse_on_second(simulation.state, static_cast<Index>(k), 3);
      CHECK(p.dot(n) == doctest::Approx(normal).epsilon(1e-7));
      CHECK((p - p.dot(n) * n).norm() == doctest::Approx(needed * normal).epsilon(1e-7));
    }
  }
}

TEST_CASE("turntable: a sphere that rolls on it goes round on a circle, 2/7 as fast as the table") {
  // m v' = F, I s' = -R n x F and rolling v = Omega n x x + R s x n give v' = 2/7 Omega n x v.
  const double radius = 0.1, omega = 3, end = 2;
  const auto error = [&](Index steps) {
    Dynamics dynamics = on_plane(up, 1, end / static_cast<double>(steps));
    dynamics.solver.tolerance = 1e-11;
    dynamics.boundaries[0].motion = moving_in_space(Vector3::Zero(), omega * up);
    const Vector3 start(0.7, 0.2, radius), velocity(0.3, -0.1, 0);
    const Vector3 table = (omega * up).cross(start);
    const Vector3 rolling = velocity - table;  // = s x (R n)
    const Vector3 spin = up.cross(rolling) / radius;
    Simulation simulation =
        simulation_of({Ball{.centre = start, .radius = radius, .velocity = velocity, .spin = spin}}, dynamics);
    advance_in_space(simulation, steps);
    const Vector3 expected = Eigen::AngleAxisd(2.0 / 7 * omega * end, up) * velocity;
    return (velocity_of_ball(simulation.state, 0) - expected).norm();
  };
  const double coarse = error(200), fine = error(400);
  CHECK(fine < 2e-3);
  CHECK(coarse / fine == doctest::Approx(2).epsilon(0.02));  // of first order: contacts obey their law at ends of steps
}

TEST_CASE("cylinder: a sphere rolls to and fro in it, at the bottom of one that turns it stays and spins") {
  const double radius = 0.1, drum = 1, step = 0.002;
  Dynamics dynamics = tight({cylinder("drum", Vector3::Zero(), 2 * Vector3::UnitY(), drum)});
  dynamics.time.step = step;
  dynamics.interaction.friction = 10;
  const auto centre = [&](double angle) {
    return Vector3((drum - radius) * std::sin(angle), 0.3, -(drum - radius) * std::cos(angle));
  };
  SUBCASE("rolls like a pendulum of 7/5 its length") {
    const double angle = 1e-3, frequency = std::sqrt(5.0 / 7 * g / (drum - radius));
    Simulation simulation = simulation_of({Ball{.centre = centre(angle), .radius = radius}}, dynamics);
    const auto steps = static_cast<Index>(std::round(std::numbers::pi / frequency / step));
    advance_in_space(simulation, steps);
    const double found = std::asin(simulation.state.x[0] / (drum - radius));
    CHECK(found == doctest::Approx(angle * std::cos(frequency * simulation.state.time)).epsilon(1e-4));
    CHECK(std::abs(simulation.state.y[0] - 0.3) < 1e-12);
  }
  SUBCASE("the drum turns under it") {
    const double omega = 2;
    dynamics.boundaries[0].motion = moving_in_space(Vector3::Zero(), Vector3(0, omega, 0));
    const Ball ball{.centre = centre(0), .radius = radius, .spin = Vector3(0, omega * drum / radius, 0)};
    Simulation simulation = simulation_of({ball}, dynamics);
    advance_in_space(simulation, 200);
    CHECK((centre_of_ball(simulation.state, 0) - ball.centre).norm() < 1e-10);
    CHECK(close(spin_of_ball(simulation.state, 0), ball.spin) < 1e-10);
  }
  SUBCASE("on the outside it falls off") {
    dynamics.boundaries[0].side = CylinderSide::outside;
    Simulation simulation =
        simulation_of({Ball{.centre = Vector3(1e-3, 0.3, drum + radius), .radius = radius}}, dynamics);
    const StepReport report = advance_in_space(simulation, 100);
    const double rate = std::sqrt(5.0 / 7 * g / (drum + radius));
    CHECK(simulation.state.x[0] == doctest::Approx(1e-3 * std::cosh(rate * simulation.state.time)).epsilon(1e-4));
    CHECK(simulation.state.impulses.size() == 1);
    CHECK(report.overlap.maximum < 1e-6);
  }
}

TEST_CASE("a driven group goes round an axis as one body, and what stands on it goes along") {
  const Vector3 axis_point(1, 0.5, 0);
  const double omega = 0.5;
  std::vector<Ball> balls;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2 * std::numbers::pi * k / 3;
    balls.push_back({.centre = Vector3(0.6 * std::cos(angle), 0.6 * std::sin(angle), 0)});
  }
  balls.push_back(
      {.centre = Vector3(0, 0, std::sqrt(1 - 0.36)), .velocity = (omega * up).cross(-axis_point), .spin = omega * up});
  const BoundarySpec spec = driven_grains("table", 0, 2, moving_in_space(Vector3::Zero(), omega * up, axis_point));
  // How far the fourth, which three hold, is from where it would be as a part of the table.
  const auto drift = [&](Index steps) {
    Dynamics dynamics = tight({spec});
    dynamics.time.step = 0.2 / static_cast<double>(steps);
    dynamics.solver.tolerance = 1e-9;
    dynamics.interaction.friction = 0.5;  // with 1 plain sweeps run round in a cycle
    Simulation simulation = simulation_of(balls, dynamics);
    const StepReport last = advance_in_space(simulation, steps);
    const GranularState& state = simulation.state;
    CHECK(state.impulses.size() == 3);
    CHECK(std::abs(last.energy.numerical) < 1e-12);      // the table's work, that of its turning grains included
    CHECK(std::abs(last.energy.boundary_work) < 1e-10);  // nothing is sped up; of third order in the step
    const Eigen::AngleAxisd turn(omega * state.time, up);
    const auto carried = [&](std::size_t k) { return Vector3(axis_point + turn * (balls[k].centre - axis_point)); };
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK((centre_of_ball(state, k) - carried(k)).norm() < 1e-11);
      CHECK(turn_of_ball(state, k).angularDistance(Eigen::Quaterniond(turn)) < 1e-7);
    }
    return (centre_of_ball(state, 3) - carried(3)).norm();
  };
  const double coarse = drift(100), fine = drift(200);
  CHECK(fine < 0.01);
  CHECK(coarse / fine == doctest::Approx(4).epsilon(0.02));  // of second order where all contacts stick
}

TEST_CASE("rotations follow each other about axes that stand still in space, of spheres and of boundaries") {
  Dynamics dynamics = tight();
  dynamics.time.step = 0.01;
  dynamics.time.gravity = {0, 0, 0};
  const double quarter = std::numbers::pi / 2;  // in 100 steps
  dynamics.boundaries = {driven_grains(
      "pair", 1, 1,
      {.centre = {5, 0, 0}, .time = {0.999, 1.001}, .velocity = {{.spin_x = quarter}, {.spin_y = quarter}}})};
  Simulation simulation = simulation_of({Ball{.spin = Vector3(quarter, 0, 0)}, Ball{.centre = {5, 2, 0}}}, dynamics);
  advance_in_space(simulation, 100);
  set_motion(simulation.state, 0, {0, 0, 0, 0, 0.5 * quarter, 0}, 0.5);
  advance_in_space(simulation, 100);
  const GranularState& s = simulation.state;
  // z goes to -y by the first, and stays there; y goes to z, then to x.
  for (const std::size_t i : {0U, 1U}) {
    CHECK((turn_of_ball(s, i) * Vector3(0, 0, 1) - Vector3(0, -1, 0)).norm() < 1e-11);
    CHECK((turn_of_ball(s, i) * Vector3(0, 1, 0) - Vector3(1, 0, 0)).norm() < 1e-11);
  }
  CHECK((centre_of_ball(s, 1) - Vector3(7, 0, 0)).norm() < 1e-11);
}

TEST_CASE("a driven group of fixed orientation goes round, but its spheres neither turn nor rub by their rims") {
  Dynamics dynamics = tight();
  dynamics.time.gravity = {0, 0, 0};
  BoundarySpec spec = driven_grains("group", 0, 0, moving_in_space(Vector3::Zero(), 2 * up, Vector3(1, 0, 0)));
  spec.orientation = Orientation::fixed;
  dynamics.boundaries = {spec};
  Simulation simulation = simulation_of({Ball{}, Ball{.centre = {9, 9, 9}}}, dynamics);
  advance_in_space(simulation, 50);
  const GranularState& s = simulation.state;
  CHECK(turn_of_ball(s, 0).vec().norm() == 0);
  CHECK(spin_of_ball(s, 0).norm() == 0);
  CHECK((centre_of_ball(s, 0) - (Vector3(1, 0, 0) - Eigen::AngleAxisd(2 * s.time, up) * Vector3(1, 0, 0))).norm() <
        1e-12);
}

TEST_CASE("cohesion: a sphere hangs below a plane while its weight is less, and falls with more") {
  for (const double share : {0.9, 1.1}) {
    Dynamics dynamics = tight({plane("ceiling", Vector3(0, 0, 0.5), -up)});
    dynamics.interaction.law = "cohesive";
    dynamics.interaction.cohesion = 2 * g / share;
    Simulation simulation = simulation_of({Ball{.mass = 2}}, dynamics);
    advance_in_space(simulation, 10);
    if (share < 1) {
      CHECK(std::abs(simulation.state.z[0]) < 1e-13);
      CHECK(close(impulse_on_second(simulation.state, 0, 1), -2 * g * dynamics.time.step * up) < 1e-12);
    } else {
      CHECK(simulation.state.z[0] < -1e-3);
    }
  }
}
