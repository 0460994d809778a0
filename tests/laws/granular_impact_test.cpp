// SPDX-License-Identifier: GPL-3.0-or-later
// Two disks that meet: momentum, Newton's restitution, Coulomb's cone.
#include "../support/granular.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Disk 1 touches disk 0 at `angle`; the middle configuration is the initial one but for h V / 2.
struct Pair {
  double m0 = 1, m1 = 1, r0 = 0.5, r1 = 0.5, angle = 0;
  std::array<double, 3> v0{}, v1{};  // x, y, spin
};

Simulation meeting(const Pair& p, const Dynamics& dynamics) {
  // Placed half a step back, so that they touch exactly where contacts are found.
  const double half = dynamics.time.step / 2, d = p.r0 + p.r1;
  return simulation_of({{-half * p.v0[0], -half * p.v0[1], p.r0, p.m0, p.v0[0], p.v0[1], p.v0[2]},
                        {d * std::cos(p.angle) - half * p.v1[0], d * std::sin(p.angle) - half * p.v1[1], p.r1, p.m1,
                         p.v1[0], p.v1[1], p.v1[2]}},
                       dynamics);
}

}  // namespace

TEST_CASE("central impact: velocities of the textbook for any masses and restitution") {
  for (const double e : {0.0, 0.3, 1.0})
    for (const double ratio : {0.01, 1.0, 50.0}) {
      INFO("e = ", e, ", ratio = ", ratio);
      Dynamics dynamics = without_gravity();
      dynamics.interaction.restitution = e;
      Simulation simulation = meeting({.m0 = 1, .m1 = ratio, .v0 = {2, 0, 0}, .v1 = {-1, 0, 0}}, dynamics);
      // Rounding decides whether the gap is 0 or 1e-17: give it a hair of overlap.
      simulation.state.x[1] -= 1e-12;
      advance(simulation);
      const double common = (2 - ratio) / (1 + ratio), reduced = ratio / (1 + ratio);
      CHECK(simulation.state.velocity_x[0] == doctest::Approx(common - e * 3 * reduced).epsilon(1e-8));
      CHECK(simulation.state.velocity_x[1] == doctest::Approx(common + e * 3 * reduced / ratio).epsilon(1e-8));
      CHECK(std::abs(simulation.state.spin[0]) < 1e-14);
      const double momentum = simulation.state.velocity_x[0] + ratio * simulation.state.velocity_x[1];
      CHECK(momentum == doctest::Approx(2 - ratio).epsilon(1e-13));
    }
}

TEST_CASE("oblique impact: each impulse by hand, sticking or on the edge of the cone") {
  // Unequal masses: W_nn = 1/m0 + 1/m1, W_tt = 3 W_nn. Velocity of the contact points along (n, t):
  // v_t = t (V1 - V0) - R0 s0 - R1 s1.
  for (const double mu : {0.0, 0.1, 0.5, 3.0})
    for (const double e : {0.0, 0.6})
      for (const double e_t : {0.0, 0.4})
        for (const double angle : {0.0, 0.7, 2.5, -1.2}) {
          INFO("mu = ", mu, ", e = ", e, ", e_t = ", e_t, ", angle = ", angle);
          Dynamics dynamics = without_gravity();
          dynamics.interaction.friction = mu;
          dynamics.interaction.restitution = e;
          dynamics.interaction.tangential_restitution = e_t;
          const double c = std::cos(angle), s = std::sin(angle);
          // Approach at 1.3 m/s along the normal, arbitrary tangential parts and spins.
          Pair pair{.m0 = 1.2, .m1 = 0.7, .r0 = 0.5, .r1 = 0.35, .angle = angle};
          pair.v0 = {0.9 * c - 0.8 * s, 0.9 * s + 0.8 * c, 1.1};
          pair.v1 = {-0.4 * c - 0.3 * s, -0.4 * s + 0.3 * c, -0.6};
          Simulation simulation = meeting(pair, dynamics);
          simulation.state.x[1] -= 1e-12 * c;
          simulation.state.y[1] -= 1e-12 * s;
          dynamics.time.penetration_correction = 0;
          simulation.dynamics = dynamics;
          advance(simulation);
          const double w = 1 / 1.2 + 1 / 0.7;
          const double v_n = -1.3, v_t = 0.3 - 0.8 - 0.5 * 1.1 + 0.35 * 0.6;
          const double r_n = -(1 + e) * v_n / w;
          double r_t = -(1 + e_t) * v_t / (3 * w);
          if (std::abs(r_t) > mu * r_n) r_t = std::copysign(mu * r_n, r_t);
          const double px = c * r_n - s * r_t, py = s * r_n + c * r_t;
          const GranularState& state = simulation.state;
          const auto near = [](double v) { return doctest::Approx(v).epsilon(1e-9); };
          CHECK(state.velocity_x[0] == near(pair.v0[0] - px / 1.2));
          CHECK(state.velocity_y[0] == near(pair.v0[1] - py / 1.2));
          CHECK(state.velocity_x[1] == near(pair.v1[0] + px / 0.7));
          CHECK(state.velocity_y[1] == near(pair.v1[1] + py / 0.7));
          // I = m R^2 / 2; the impulse -r_t t on disk 0 acts at +R0 n, r_t t on disk 1 at -R1 n.
          CHECK(state.spin[0] == near(1.1 - 0.5 * r_t / (1.2 * 0.5 * 0.5 / 2)));
          CHECK(state.spin[1] == near(-0.6 - 0.35 * r_t / (0.7 * 0.35 * 0.35 / 2)));
          // Angular momentum about the contact point, where all impulses act.
          const auto moment = [&](double vx0, double vy0, double s0, double vx1, double vy1, double s1) {
            const double x0 = -0.5 * c, y0 = -0.5 * s, x1 = 0.35 * c, y1 = 0.35 * s;
            return 1.2 * (x0 * vy0 - y0 * vx0 + 0.125 * s0) + 0.7 * (x1 * vy1 - y1 * vx1 + 0.35 * 0.35 / 2 * s1);
          };
          CHECK(moment(state.velocity_x[0], state.velocity_y[0], state.spin[0], state.velocity_x[1],
                       state.velocity_y[1],
                       state.spin[1]) == near(moment(pair.v0[0], pair.v0[1], 1.1, pair.v1[0], pair.v1[1], -0.6)));
        }
}

TEST_CASE("separating disks do not feel each other, with or without restitution") {
  for (const double e : {0.0, 0.5}) {
    Dynamics dynamics = without_gravity();
    dynamics.interaction.restitution = e;
    dynamics.interaction.tangential_restitution = 0.5;
    Simulation simulation = meeting({.angle = 0.3, .v0 = {-1, 0, 2}, .v1 = {1, 0.2, -3}}, dynamics);
    advance(simulation);
    CHECK(simulation.state.velocity_x == std::vector<double>{-1, 1});
    CHECK(simulation.state.velocity_y == std::vector<double>{0, 0.2});
    CHECK(simulation.state.spin == std::vector<double>{2, -3});
  }
}

TEST_CASE("a moving wall throws a disk back: Newton's law in the frame of the wall") {
  // v' = U - e (v - U) along the normal.
  for (const double e : {0.0, 0.5, 1.0}) {
    Dynamics dynamics = without_gravity();
    dynamics.interaction.restitution = e;
    dynamics.time.penetration_correction = 0;
    dynamics.boundaries = {wall("racket", {0, 0}, {1, 0}, moving({0, 0.8, 0}))};
    Simulation simulation = simulation_of({{.y = 0.5, .velocity_y = -1.1}}, dynamics);
    advance(simulation);
    CHECK(simulation.state.velocity_y[0] == doctest::Approx(0.8 + e * 1.9).epsilon(1e-13));
  }
}

TEST_CASE("without restitution two disks stop each other just when they touch, however fast they come") {
  // The predicted gap lets them close the distance within the step of the impact and no more.
  for (const double speed : {0.5, 20.0, 700.0}) {
    CAPTURE(speed);
    Dynamics dynamics = without_gravity();
    dynamics.time.step = 0.005;
    Simulation simulation = simulation_of({{.velocity_x = speed}, {.x = 1 + 2.3 * speed * 0.005}}, dynamics);
    for (int k = 0; k < 6; ++k) advance(simulation);
    const GranularState& s = simulation.state;
    CHECK(s.velocity_x[0] == doctest::Approx(speed / 2).epsilon(1e-12));
    CHECK(s.velocity_x[1] == doctest::Approx(speed / 2).epsilon(1e-12));
    CHECK(s.x[1] - s.x[0] == doctest::Approx(1.0).epsilon(1e-12));
  }
}

TEST_CASE("a chain of equal touching disks hit by another with e = 0 moves as one") {
  std::vector<nscdd::testing::Grain> grains{{.x = -1, .velocity_x = 6}};
  for (int k = 0; k < 5; ++k) grains.push_back({.x = static_cast<double>(k)});
  Simulation simulation = simulation_of(grains, without_gravity());
  simulation.state.x[0] -= 0.5e-3 * 6;  // touches at q_m
  advance(simulation);
  for (const double v : simulation.state.velocity_x) CHECK(v == doctest::Approx(1.0).epsilon(1e-10));
}

TEST_CASE("a disk that moves away from another is not driven into it by a third, whatever the restitution") {
  // Disks 0, 1 and 2 touch in a row. Disk 1 moves away from disk 0 when disk 2 hits it. Disks 0 and 1, which did not
  // approach each other, move on with one velocity u; disk 2 is thrown back: 3 u + e (1 + 3) = 1 - 3.
  for (const double e : {0.25, 0.5, 1.0}) {
    CAPTURE(e);
    Dynamics dynamics = without_gravity();
    dynamics.interaction.restitution = e;
    dynamics.time.theta = 1;  // contacts are found where the disks are
    Simulation simulation = simulation_of({{}, {.x = 1, .velocity_x = 1}, {.x = 2, .velocity_x = -3}}, dynamics);
    advance(simulation);
    const double together = -(2 + 4 * e) / 3;
    const std::vector<double>& v = simulation.state.velocity_x;
    CHECK(v[0] == doctest::Approx(together).epsilon(1e-8));
    CHECK(v[1] == doctest::Approx(together).epsilon(1e-8));
    CHECK(v[2] == doctest::Approx(together + 4 * e).epsilon(1e-8));
  }
}
