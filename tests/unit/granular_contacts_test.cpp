// SPDX-License-Identifier: GPL-3.0-or-later
// Which contacts a step considers, where boundaries are and how they move, what is refused.
#include "../support/granular.hpp"
#include "linalg/random.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

StepProblem<2> prepared(const Simulation& s) { return prepare_step<2>(start_of(s), s.dynamics.solver.warm_start); }

std::set<std::pair<Index, Index>> pairs_of(const StepProblem<2>& problem) {
  std::set<std::pair<Index, Index>> result;
  for (const StepContact& c : problem.geometry) result.insert({c.a, c.b});
  return result;
}

}  // namespace

TEST_CASE("contacts: every pair that is near or would be at the end of the step, none else, in order") {
  int far = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    RandomStream random(seed);
    Dynamics dynamics;
    dynamics.time.step = 0.01;
    dynamics.time.alert = 0.2;
    std::vector<Grain> grains;
    for (int i = 0; i < 120; ++i)
      grains.push_back({.x = 8 * random.uniform(),
                        .y = 8 * random.uniform(),
                        .radius = 0.1 + 0.2 * random.uniform(),
                        .velocity_x = 10 * random.uniform() - 5,
                        .velocity_y = 10 * random.uniform() - 5});
    const Simulation s = simulation_of(grains, dynamics);
    const StepProblem<2> problem = prepared(s);
    double smallest = 1;
    for (const Grain& one : grains) smallest = std::min(smallest, one.radius);
    const double alert = 0.2 * smallest, h = 0.01;
    std::set<std::pair<Index, Index>> expected;
    for (Index a = 0; a < 120; ++a)
      for (Index b = a + 1; b < 120; ++b) {
        const Grain &p = grains[at(a)], &q = grains[at(b)];
        const double vx = q.velocity_x - p.velocity_x, vy = q.velocity_y - p.velocity_y;
        const double dx = q.x - p.x + h / 2 * vx, dy = q.y - p.y + h / 2 * vy, d = std::hypot(dx, dy);
        const double gap = d - p.radius - q.radius, closing = (dx * vx + dy * vy) / d;
        bool foreseen = gap + h * closing <= alert;
        if (h * std::hypot(vx, vy) > 0.5 * std::min(p.radius, q.radius)) {  // far: only if they touch within the step
          const double t = std::clamp(-(dx * vx + dy * vy) / (vx * vx + vy * vy), 0.0, h);
          foreseen = foreseen && std::hypot(dx + t * vx, dy + t * vy) <= p.radius + q.radius;
          far += !foreseen && gap > alert && gap + h * closing <= alert;
        }
        if (gap <= alert || foreseen) expected.insert({a, b});
      }
    CHECK(pairs_of(problem) == expected);
    CHECK(std::is_sorted(
        problem.geometry.begin(), problem.geometry.end(),
        [](const StepContact& p, const StepContact& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); }));
  }
  CHECK(far > 0);  // pairs that miss each other
}

TEST_CASE("contacts: a wall that comes fast is met in time, one that leaves is left alone") {
  // The wall closes 0.05 m a step; the grain at rest is 0.02 m away, alert distance 0.005 m.
  for (const double speed : {10.0, -10.0}) {
    CAPTURE(speed);
    const Dynamics dynamics = without_gravity({wall("piston", {0, 1}, {0, 0}, moving({speed, 0, 0}))}, 0.005);
    Simulation s = simulation_of({{.x = 0.12 + speed * 0.0025, .radius = 0.1}}, dynamics);
    double deepest = 0;
    for (int k = 0; k < 3; ++k) {
      const GranularStep<2> step = solve_step(s);
      deepest = std::max(deepest, step.report.overlap.maximum);
      take_step(s, step);
    }
    CHECK(deepest < 1e-12);
    CHECK(s.state.velocity_x[0] == doctest::Approx(speed > 0 ? speed : 0).epsilon(1e-12));
  }
}

TEST_CASE("contacts with a wall: near, or within reach at the velocities of grain and wall, none else") {
  Dynamics dynamics;
  dynamics.time.gravity = {0, 0};
  dynamics.time.alert = 0.1;
  dynamics.boundaries = {floor_wall()};
  // Radius 0.1: alert 0.01 m; at 4 m/s a step of 0.005 s closes 0.02 m, half of it before q_m.
  const Simulation s = simulation_of({{.x = 0, .y = 0.109, .radius = 0.1},
                                      {.x = 1, .y = 0.112, .radius = 0.1},
                                      {.x = 2, .y = 0.135, .radius = 0.1, .velocity_y = -4},
                                      {.x = 3, .y = 0.145, .radius = 0.1, .velocity_y = -4},
                                      {.x = 4, .y = 0.112, .radius = 0.1, .velocity_y = 4}},
                                     dynamics);
  CHECK(pairs_of(prepared(s)) == std::set<std::pair<Index, Index>>{{0, 5}, {2, 5}});
}

TEST_CASE("contacts: driven disks do not meet each other or walls, and carry no alert of free ones") {
  Dynamics dynamics;
  dynamics.boundaries = {row_of_disks("row", {0, 0}, {3, 0}, 0.5), floor_wall()};
  const Simulation s = simulation_of({{.x = 1.5, .y = std::sqrt(0.75)}}, dynamics);
  CHECK(s.system.grains() == 5);
  CHECK(pairs_of(prepared(s)) == std::set<std::pair<Index, Index>>{{0, 2}, {0, 3}});
}

TEST_CASE("a row of disks has both ends and gaps no wider than asked for") {
  Dynamics dynamics;
  BoundarySpec row = row_of_disks("row", {1, 2}, {1, 5}, 0.2);
  row.spacing = 0.7;  // 3 m in gaps of 0.6 m
  dynamics.boundaries = {row};
  const Simulation s = simulation_of({{.x = 10}}, dynamics);
  REQUIRE(s.system.grains() == 7);
  for (Index k = 0; k <= 5; ++k) {
    CHECK(s.state.x[at(k + 1)] == 1);
    CHECK(s.state.y[at(k + 1)] == doctest::Approx(2 + 0.6 * static_cast<double>(k)).epsilon(1e-15));
  }
}

TEST_CASE("driven motion: rotation about a foot, translation and both, at exact places after many steps") {
  const double omega = 0.75, u = 0.4, h = 0.005;
  Dynamics dynamics;
  dynamics.time.step = h;
  dynamics.boundaries = {row_of_disks("row", {2, 0}, {2, 4}, 0.5, moving({u, 0, omega}, {2, 0})),
                         wall("wall", {-3, 1}, {-3, 0}, moving({0, u, -omega}, {-3, 0}))};
  Simulation s = simulation_of({{.x = 50, .y = 50}}, dynamics);
  const int steps = 400;
  for (int k = 0; k < steps; ++k) take_step(s, solve_step(s));
  const double t = steps * h, c = std::cos(omega * t), sine = std::sin(omega * t);
  for (Index k = 0; k <= 4; ++k) {
    const auto i = at(k + 1);
    const double arm = static_cast<double>(k);
    CHECK(std::abs(s.state.x[i] - (2 + u * t - arm * sine)) < 1e-11);
    CHECK(std::abs(s.state.y[i] - arm * c) < 1e-11);
    CHECK(std::abs(s.state.angle[i] - omega * t) < 1e-11);
    CHECK(s.state.spin[i] == doctest::Approx(omega).epsilon(1e-14));
  }
  const Wall at_end = moved(s.system.walls[0], s.system.boundaries[1].motion, s.state.poses[1]);
  CHECK(std::hypot(at_end.normal[0] - std::cos(-omega * t), at_end.normal[1] - std::sin(-omega * t)) < 1e-12);
  // The given point (-3, 1) turns about the foot, which rises.
  CHECK(std::abs(at_end.point[0] - (-3 + sine)) < 1e-11);
  CHECK(std::abs(at_end.point[1] - (u * t + c)) < 1e-11);
}

TEST_CASE("a table of velocities moves a boundary by its integral, exactly where steps end at its times") {
  // 0 to 2 m/s in 0.1 s, steady for 0.2 s, back to -1 m/s in 0.3 s, steady after: 0.1 + 0.4 + 0.15 - 0.1 m.
  Motion motion;
  motion.time = {0, 0.1, 0.3, 0.6};
  motion.velocity = {{0, 0, 0}, {2, 0, 0.5}, {2, 0, 0.5}, {-1, 0, 0}};
  CHECK(motion.at(-1).x == 0);
  CHECK(motion.at(0.05).x == doctest::Approx(1));
  CHECK(motion.at(0.45).x == doctest::Approx(0.5));
  CHECK(motion.at(0.45).spin == doctest::Approx(0.25));
  CHECK(motion.at(7).x == -1);
  Dynamics dynamics;
  dynamics.time.step = 0.005;
  dynamics.boundaries = {driven_grains("group", 1, -1, motion)};
  Simulation s = simulation_of({{.x = 50, .y = 50}, {.x = 1}, {.x = 0, .y = 2}}, dynamics);
  for (int k = 0; k < 140; ++k) take_step(s, solve_step(s));
  const double path = 0.1 + 0.4 + 0.15 - 0.1, angle = 0.5 * (0.05 + 0.2 + 0.15);
  CHECK(s.state.poses[0].x == doctest::Approx(path).epsilon(1e-12));
  CHECK(s.state.poses[0].angle == doctest::Approx(angle).epsilon(1e-12));
  CHECK(s.state.x[1] == doctest::Approx(path + std::cos(angle)).epsilon(1e-11));
  CHECK(s.state.y[1] == doctest::Approx(std::sin(angle)).epsilon(1e-11));
  CHECK(s.state.x[2] == doctest::Approx(path - 2 * std::sin(angle)).epsilon(1e-11));
}

TEST_CASE("a disk on a spinning drum is set going as on a belt of the speed of its surface, wherever the drum is") {
  // The top of the drum moves at -2.25 m/s; sticking, the disk gets a third of it and spins the other way.
  for (const std::array<double, 2> centre : {std::array{0.0, 0.0}, std::array{4.0, -2.0}}) {
    CAPTURE(centre[0]);
    Dynamics dynamics = tight();
    dynamics.interaction.friction = 100;
    dynamics.boundaries = {driven_grains("drum", 1, 1, moving({0, 0, 3}, centre))};
    Simulation s = simulation_of({{.x = centre[0], .y = centre[1] + 1.25, .radius = 0.5, .mass = 2},
                                  {.x = centre[0], .y = centre[1], .radius = 0.75}},
                                 dynamics);
    const StepReport report = advance(s);
    CHECK(s.state.velocity_x[0] == doctest::Approx(-0.75).epsilon(1e-12));
    CHECK(s.state.spin[0] == doctest::Approx(-1.5 / 0.5).epsilon(1e-12));
    CHECK(s.state.spin[1] == 3);
    // The drum gives the impulse 2 kg x 0.75 m/s at 2.25 m/s.
    CHECK(report.energy.boundary_work == doctest::Approx(2 * 0.75 * 2.25).epsilon(1e-12));
  }
}

TEST_CASE("overlaps: the largest, their mean, and the largest as a part of the smaller radius") {
  // Disk 0 overlaps disk 1 by 0.0625 and disk 2, which is small, by 0.03125; disk 3 touches nothing.
  const Simulation s = simulation_of(
      {{.radius = 1}, {.x = 1.9375, .radius = 1}, {.x = -1.09375, .radius = 0.125}, {.x = -2, .radius = 0.5}},
      Dynamics());
  const Interpenetration found = solve_step(s).report.overlap;
  CHECK(found.maximum == 0.0625);
  CHECK(found.mean == (0.0625 + 0.03125) / 2);
  CHECK(found.relative == 0.03125 / 0.125);
}

TEST_CASE("prepare_step refuses what cannot be computed, and names it") {
  Dynamics dynamics;
  Simulation s = simulation_of({{.x = 0}, {.x = 3}, {.x = 6}}, dynamics);
  Simulation broken = s;
  broken.state.velocity_y[1] = not_a_number;
  CHECK_THROWS_WITH_AS(prepared(broken), doctest::Contains("disk 1"), Error);
  broken = s;
  broken.state.spin[2] = infinity;
  CHECK_THROWS_WITH_AS(prepared(broken), doctest::Contains("disk 2"), Error);
  broken = s;
  broken.state.velocity_x[2] = 1001;  // ten radii of 0.5 m in 0.005 s are 1 000 m/s
  CHECK_THROWS_WITH_AS(prepared(broken), doctest::Contains("disk 2"), Error);
  broken.state.velocity_x[2] = 999;
  CHECK_NOTHROW(prepared(broken));
  broken = s;
  broken.state.x[1] = 0;
  CHECK_THROWS_WITH_AS(prepared(broken), doctest::Contains("disk 0 and disk 1"), Error);
  broken = s;
  broken.state.x[1] = not_a_number;
  CHECK_THROWS_WITH_AS(prepared(broken), doctest::Contains("disk 1"), Error);
}

TEST_CASE("a scene refuses boundaries that cannot be, and names them") {
  const std::vector<Grain> grains{{.x = 0}, {.x = 3}};
  const auto refused = [&](const BoundarySpec& spec, const std::string& with) {
    Dynamics dynamics;
    dynamics.boundaries = {spec};
    CHECK_THROWS_WITH_AS(simulation_of(grains, dynamics), doctest::Contains(with.c_str()), Error);
  };
  refused(wall("flat", {1, 1}, {1, 1}), "'flat'");
  refused(wall("bad", {0, 0}, {infinity, 1}), "'bad'");
  refused(row_of_disks("row", {0, 5}, {1, 5}, 0), "'row'");
  refused(driven_grains("group", 1, 2), "'group'");
  refused(driven_grains("group", 0, -1), "free grain");
  Motion motion{.centre = {0, 0}, .time = {0, 0}, .velocity = {{}, {}}};
  refused(wall("twice", {0, 0}, {1, 0}, motion), "'twice'");
  motion.time = {0};
  refused(wall("short", {0, 0}, {1, 0}, motion), "'short'");
  motion = moving({not_a_number, 0, 0});
  refused(wall("none", {0, 0}, {1, 0}, motion), "'none'");
}
