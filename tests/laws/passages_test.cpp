// SPDX-License-Identifier: GPL-3.0-or-later
// What happens between two searches for contacts: bodies that meet there exchange momentum as they should, however long
// the step, or the step is refused, and the one that the refusal names does.
#include "../support/spheres.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Without a step where try_steps chooses it.
Dynamics free_flight(double restitution = 0, double step = 0, const std::vector<BoundarySpec>& boundaries = {}) {
  Dynamics dynamics;
  dynamics.boundaries = boundaries;
  dynamics.solver.tolerance = 1e-12;
  dynamics.interaction.law = "frictionless";
  dynamics.interaction.restitution = restitution;
  dynamics.time.gravity = {0, 0, 0};
  dynamics.time.maximum_push_speed = 0;
  dynamics.time.step = step;
  return dynamics;
}

// How a run ends. `refusal`: why it ended early, empty otherwise.
struct Ended {
  Simulation simulation;
  std::string refusal;

  bool refused() const { return !refusal.empty(); }
  std::array<double, 2> velocity(std::size_t grain) const {
    return {simulation.state.velocity_x[grain], simulation.state.velocity_y[grain]};
  }
};

Ended run_for(Simulation simulation, double step, double time) {
  simulation.dynamics.time.step = step;
  simulation.dynamics.time.steps = static_cast<Index>(std::ceil(time / step));
  const std::string refusal = refusal_of(simulation);
  return {std::move(simulation), refusal};
}

// The step that a refusal names.
double named_step(const std::string& refusal) {
  CAPTURE(refusal);
  const bool moves = refusal.find("of its radii") != std::string::npos;  // the other refusal of a long step
  const std::string before = "dynamics.step: expected at most ";
  const std::size_t found = refusal.find(before);
  REQUIRE(found != std::string::npos);
  if (!moves) CHECK(refusal.find("which is too long") != std::string::npos);
  return std::stod(refusal.substr(found + before.size()));
}

// Runs a scene with steps of ever other lengths. Where one is refused, the step named is not, nor 0.99 of it. All that
// are not refused end well. Returns how many were refused.
template <class Check>
int try_steps(double shortest, double longest, double time, const Simulation& scene, const Check& check) {
  int refusals = 0;
  for (double h = shortest; h <= longest; h *= 1.4) {
    CAPTURE(h);
    const Ended ended = run_for(scene, h, time);
    if (!ended.refused()) {
      check(ended);
      continue;
    }
    ++refusals;
    const double safe = named_step(ended.refusal);
    CHECK(safe < h);
    for (const double shorter : {safe, 0.99 * safe}) {
      CAPTURE(shorter);
      const Ended again = run_for(scene, shorter, time);
      CHECK(again.refusal == "");
      if (!again.refused()) check(again);
    }
  }
  return refusals;
}

// The largest error of a velocity that a normal which is off by largest_turn leaves, as a part of the relative speed.
constexpr double turn_error = 0.1;

}  // namespace

TEST_CASE("passages: grains that meet head-on end with the speed of their momentum, or the step is refused") {
  struct Pair {
    double r0, m0, r1, m1, gap, speed;
  };
  const Pair pairs[] = {
      {0.01, 1, 0.01, 1, 0.002, 19},     {0.01, 1, 0.01, 1, 0, 19},        {0.01, 1, 0.01, 1, 0.03, 19},
      {0.01, 1e-3, 0.01, 10, 0.002, 19}, {0.01, 10, 0.01, 1e-3, 0.002, 7}, {0.01, 1, 0.05, 125, 0.002, 19},
      {0.05, 125, 0.01, 1, 0.002, 19},   {0.01, 1, 0.0013, 2e-3, 0.01, 3}, {1, 3, 0.9, 2, 0.4, 250}};
  for (const Pair& p : pairs) {
    INFO("p.r0 = ", p.r0, ", p.r1 = ", p.r1, ", p.m0 = ", p.m0, ", p.gap = ", p.gap);
    for (const double theta : {0.5, 0.75, 1.0}) {
      CAPTURE(theta);
      Dynamics dynamics = free_flight();
      dynamics.time.theta = theta;
      const Simulation scene = simulation_of({{.radius = p.r0, .mass = p.m0, .velocity_x = p.speed},
                                              {.x = p.r0 + p.gap + p.r1, .radius = p.r1, .mass = p.m1}},
                                             dynamics);
      const double least = std::min(p.r0, p.r1), right = p.m0 * p.speed / (p.m0 + p.m1);
      const int refused = try_steps(0.05 * least / p.speed, 9.9 * least / p.speed, (p.gap + 20 * p.r0) / p.speed, scene,
                                    [&](const Ended& ended) {
                                      CHECK(ended.velocity(0)[0] == doctest::Approx(right).epsilon(1e-9));
                                      CHECK(ended.velocity(1)[0] == doctest::Approx(right).epsilon(1e-9));
                                    });
      if (theta == 1) CHECK(refused == 0);  // contacts are found where the run begins
      if (theta == 0.5 && p.gap < p.r0) CHECK(refused > 0);
    }
  }
}

TEST_CASE("passages: oblique impacts, with restitution from anywhere, without from the first half step") {
  const double r0 = 0.3, r1 = 0.5, m0 = 0.7, m1 = 2, speed = 3, touch = r0 + r1;
  for (const double restitution : {0.0, 0.5, 1.0})
    for (const double part : {0.0, 0.2, 0.5, 0.7, 0.85, 0.95, 0.99}) {
      INFO("restitution = ", restitution, ", part = ", part);
      const double offset = part * touch, along = std::sqrt(touch * touch - offset * offset);
      // Along the path: far away, or in touch to begin with (by rounding 1e-16 before or after).
      const double gap = restitution == 0.5 ? 1.7 : 0;
      const Simulation scene = simulation_of(
          {{.x = -along - gap, .radius = r0, .mass = m0, .velocity_x = speed}, {.y = offset, .radius = r1, .mass = m1}},
          free_flight(restitution));
      const double cosine = along / touch, sine = part,
                   impulse = (1 + restitution) * speed * cosine / (1 / m0 + 1 / m1);
      const std::array<double, 2> v0{speed - impulse * cosine / m0, -impulse * sine / m0};
      const std::array<double, 2> v1{impulse * cosine / m1, impulse * sine / m1};
      // A graze that turns by less than 0.1 rad is not a contact.
      const double error = turn_error * (1 + restitution) * speed;
      try_steps(0.01 * r0 / speed, 9.9 * r0 / speed, (gap + 10) / speed, scene, [&](const Ended& ended) {
        for (std::size_t k = 0; k < 2; ++k) {
          CHECK(std::abs(ended.velocity(0)[k] - v0[k]) < error);
          CHECK(std::abs(ended.velocity(1)[k] - v1[k]) < error);
          CHECK(m0 * ended.velocity(0)[k] + m1 * ended.velocity(1)[k] ==
                doctest::Approx(k == 0 ? m0 * speed : 0).epsilon(1e-12));
        }
      });
    }
}

TEST_CASE("passages: a pair that met and parted has the normal of its meeting, exactly") {
  // Disks of radius 0.5 pass at an offset of 0.8 m: contact would be lost, as they are 0.1 m apart at the first search.
  for (const double offset : {0.8, 0.9}) {
    CAPTURE(offset);
    const double along = std::sqrt(1 - offset * offset), way = 2 * along + 0.2;
    Simulation s = simulation_of({{.x = -along - 0.1, .velocity_x = 10}, {.y = offset}}, free_flight(0, way / 5));
    const GranularStep<2> step = solve_step(s);
    REQUIRE(step.problem.geometry.size() == 1);
    CHECK(step.problem.geometry[0].normal[0] == doctest::Approx(along).epsilon(1e-12));
    CHECK(step.problem.geometry[0].normal[1] == doctest::Approx(offset).epsilon(1e-12));
    CHECK(step.problem.geometry[0].gap == 0);
    take_step(s, step);
    CHECK(s.state.velocity_x[1] == doctest::Approx(5 * along * along).epsilon(1e-12));
    CHECK(s.state.velocity_y[1] == doctest::Approx(5 * along * offset).epsilon(1e-12));
    CHECK(s.state.velocity_x[0] == doctest::Approx(10 - 5 * along * along).epsilon(1e-12));
    CHECK(s.state.velocity_y[0] == doctest::Approx(-5 * along * offset).epsilon(1e-12));
  }
}

TEST_CASE("passages: two grains that cross at right angles") {
  for (const double delay : {0.0, 0.3, 0.6}) {
    CAPTURE(delay);
    const double speed = 40, touch = 0.2;
    // Seen from disk 0, disk 1 flies along (-1, 1) / sqrt 2 and misses its centre by delay / sqrt 2 times the touch.
    const Simulation scene = simulation_of({{.x = -0.5, .radius = 0.1, .velocity_x = speed},
                                            {.y = -0.5 - delay * touch, .radius = 0.1, .velocity_y = speed}},
                                           free_flight(1));
    const double sine = delay / std::sqrt(2), normal_speed = std::sqrt(1 - sine * sine) * speed * std::sqrt(2);
    try_steps(1e-4, 9e-1 / speed, 0.06, scene, [&](const Ended& ended) {
      const auto a = ended.velocity(0), b = ended.velocity(1);
      const double gained = std::hypot(a[0] - speed, a[1]);  // of equal masses: the normal speed is exchanged
      CHECK(std::abs(gained - normal_speed) < 2 * turn_error * speed * std::sqrt(2));
      CHECK(a[0] + b[0] == doctest::Approx(speed).epsilon(1e-12));
      CHECK(a[1] + b[1] == doctest::Approx(speed).epsilon(1e-12));
      CHECK(std::hypot(std::hypot(a[0], a[1]), std::hypot(b[0], b[1])) ==
            doctest::Approx(speed * std::sqrt(2)).epsilon(1e-9));
    });
  }
}

TEST_CASE("passages: spheres, and a row of driven ones") {
  const Vector3 direction = Vector3(1, 2, -2) / 3;
  const double touch = 0.5;  // radii 0.2 and 0.3
  for (const bool driven : {false, true})
    for (const double part : {0.0, 0.6, 0.9}) {
      INFO("driven = ", driven, ", part = ", part);
      const Vector3 aside = direction.cross(Vector3(0, 0, 1)).normalized() * part * touch;
      const Vector3 start = -direction * (std::sqrt(1 - part * part) * touch + 0.01) - aside;
      Dynamics dynamics = free_flight(0.5);
      if (driven) dynamics.boundaries = {driven_grains("target", 1, 1)};
      const Simulation scene = simulation_of(
          {Ball{.centre = start, .radius = 0.2, .mass = 2, .velocity = 5 * direction}, Ball{.radius = 0.3, .mass = 3}},
          dynamics);
      const Vector3 normal = (std::sqrt(1 - part * part) * direction + aside / touch).normalized();
      const double impulse = 1.5 * 5 * direction.dot(normal) / (1 / 2.0 + (driven ? 0 : 1 / 3.0));
      const Vector3 right = 5 * direction - impulse / 2 * normal;
      const int refused = try_steps(1e-3, 0.39, 1, scene, [&](const Ended& ended) {
        CHECK((velocity_of_ball(ended.simulation.state, 0) - right).norm() < turn_error * 1.5 * 5);
      });
      if (part < 0.8) CHECK(refused > 0);  // half the smaller radius is a fifth of the way between the centres
    }
}

TEST_CASE("passages: a wall that comes fast, or a grain that flies at it, are met or refused") {
  for (const double restitution : {0.0, 0.5})
    for (const bool wall_moves : {false, true}) {
      INFO("restitution = ", restitution, ", wall_moves = ", wall_moves);
      const Simulation scene = simulation_of(
          {{.y = 0.4, .radius = 0.1, .velocity_x = 1, .velocity_y = wall_moves ? 0 : -8.0}},
          free_flight(restitution, 0, {wall("wall", {-1, 0}, {1, 0}, moving({0, wall_moves ? 8.0 : 0.0, 0}))}));
      // The wall keeps its speed. The grain leaves it at `restitution` times the speed that they met with.
      const double right = (wall_moves ? 8 : 0) + restitution * 8;
      const int refused = try_steps(1e-3, 0.9 / 8, 0.3, scene, [&](const Ended& ended) {
        CHECK(ended.velocity(0)[0] == doctest::Approx(1).epsilon(1e-12));
        CHECK(ended.velocity(0)[1] == doctest::Approx(right).epsilon(1e-9));
      });
      CHECK(refused > 0);
    }
}

TEST_CASE("passages: a disk between rows that move, and turn") {
  // The plate of one driven disk flies through a grain at rest; a paddle of driven disks turns through another.
  for (const bool turns : {false, true}) {
    CAPTURE(turns);
    // At an arm of 3 m: 12 m/s too, which meet the grain head-on after a quarter of a turn.
    const Simulation scene = simulation_of(
        {{.x = turns ? 0.0 : 2.0, .y = turns ? 3.0 : 0.0, .radius = 0.2}, {.x = turns ? 3.0 : 0.0, .radius = 0.2}},
        free_flight(1, 0, {driven_grains("plate", 1, 1, turns ? moving({0, 0, 4}) : moving({12, 0, 0}))}));
    const int refused = try_steps(1e-3, 0.16, 0.45, scene, [&](const Ended& ended) {
      // Perfect restitution: the grain leaves at twice the speed of the plate.
      const auto v = ended.velocity(0);
      CHECK(std::hypot(v[0], v[1]) == doctest::Approx(24).epsilon(0.02));
      CHECK(std::abs(turns ? v[1] : v[1]) < 24 * (turns ? 0.25 : 1e-9));
    });
    CHECK(refused > 0);
  }
}

TEST_CASE("passages: what rides on a turning boundary does not turn") {
  // Inside of a disk that goes round at an arm of 1 m, by 0.15 rad until contacts are found.
  const Dynamics dynamics = free_flight(0, 0.1, {driven_grains("drum", 1, 1, moving({0, 0, 3}))});
  const StepProblem<2> problem =
      solve_step(simulation_of({{.x = 0.5, .radius = 0.2, .velocity_y = 1.5}, {.x = 1, .radius = 0.3}}, dynamics))
          .problem;
  REQUIRE(problem.geometry.size() == 1);
  const double x = std::cos(0.15) - 0.5, y = std::sin(0.15) - 0.5 * 0.15, length = std::hypot(x, y);
  CHECK(problem.geometry[0].normal[0] == doctest::Approx(x / length).epsilon(1e-12));
  CHECK(problem.geometry[0].normal[1] == doctest::Approx(y / length).epsilon(1e-12));
  CHECK(problem.geometry[0].gap == doctest::Approx(length - 0.5).epsilon(1e-12));
}

TEST_CASE("passages: a cylinder that grains are outside of, and one that they are inside of") {
  for (const bool inside : {false, true}) {
    CAPTURE(inside);
    const BoundarySpec post = cylinder("cylinder", Vector3::Zero(), Vector3::UnitY(), inside ? 1.4 : 0.1,
                                       inside ? CylinderSide::inside : CylinderSide::outside);
    const Simulation scene =
        simulation_of({Ball{.centre = {-1, 3, 0}, .radius = 0.2, .velocity = {7, 2, 0}}}, free_flight(1, 0, {post}));
    const int refused = try_steps(1e-3, 0.25, inside ? 0.45 : 0.3, scene, [&](const Ended& ended) {
      const Vector3 v = velocity_of_ball(ended.simulation.state, 0);
      CHECK((v - Vector3(-7, 2, 0)).norm() < 1e-9);
    });
    CHECK(refused > 0);
  }
}

TEST_CASE("passages: a piston that turns back before contacts are found has hit the grain, or the step is refused") {
  for (const bool disk : {false, true}) {
    CAPTURE(disk);
    // 10 m/s until 0.1 s, then back as fast: it reaches 1 m, by 0.1 m into where the grain rests.
    BoundarySpec piston = disk ? driven_grains("piston", 1, 1) : wall("piston", {0, 1}, {0, 0});
    piston.motion = moving({10, 0, 0});
    piston.motion.time = {0, 0.0999, 0.1001};
    piston.motion.velocity = {{10, 0, 0}, {10, 0, 0}, {-10, 0, 0}};
    std::vector<Grain> grains{{.x = 1.4}};
    if (disk) grains[0].x += 0.5, grains.push_back({});
    const Simulation scene = simulation_of(grains, free_flight(1, 0, {piston}));
    for (int steps = 1; steps <= 64; ++steps) {
      CAPTURE(steps);
      const Ended ended = run_for(scene, 0.1 / steps, 0.4);
      if (!ended.refused()) CHECK(ended.velocity(0)[0] == doctest::Approx(20).epsilon(1e-9));
      if (ended.refused()) named_step(ended.refusal);
      if (steps > 30) CHECK(!ended.refused());
    }
  }
}

TEST_CASE("passages: a grain that falls ever faster is met by a plate or a heavy grain, or its step is refused") {
  for (const double theta : {0.5, 0.8, 1.0})
    for (const bool grain : {false, true}) {
      INFO("theta = ", theta, ", grain = ", grain);
      const double height = 2, radius = 0.02, gravity = 9.81, restitution = 0.8;
      Dynamics dynamics = tight({grain ? driven_grains("plate", 1, 1) : floor_wall()});
      dynamics.interaction.law = "frictionless";
      dynamics.interaction.restitution = restitution;
      dynamics.time.gravity = {0, -gravity};
      dynamics.time.theta = theta;
      std::vector<Grain> grains{{.y = height + radius, .radius = radius}};
      if (grain) grains.push_back({.y = -0.01, .radius = 0.01});
      const Simulation scene = simulation_of(grains, dynamics);
      const double speed = std::sqrt(2 * gravity * height), meets = speed / gravity, after = 0.1;
      const int refused = try_steps(1e-4, 0.03, meets + after, scene, [&](const Ended& ended) {
        const double h = ended.simulation.dynamics.time.step, time = ended.simulation.state.time;
        const double right = restitution * speed - gravity * (time - meets);
        CHECK(std::abs(ended.velocity(0)[1] - right) < 4 * gravity * h);
        CHECK(std::abs(ended.velocity(0)[0]) < 1e-12);
      });
      CHECK(refused > 0);
    }
}

TEST_CASE("passages: a light grain that a heavy one throws does not fly through a third") {
  // Head-on with restitution e: the light one is thrown at v1 = (1 + e) m0 v / (m0 + m1), faster than the heavy one.
  for (const double restitution : {0.0, 1.0})
    for (const double gap : {0.3, 1.1, 2.7}) {
      INFO("restitution = ", restitution, ", gap = ", gap);
      const double m0 = 20, m1 = 0.5, m2 = 0.5, speed = 6;
      const Simulation scene = simulation_of({{.radius = 0.3, .mass = m0, .velocity_x = speed},
                                              {.x = 0.5 + 0.02, .radius = 0.2, .mass = m1},
                                              {.x = 0.5 + 0.02 + 0.4 + gap, .radius = 0.2, .mass = m2}},
                                             free_flight(restitution));
      // Equal light masses: with e = 1 the third takes all of the second, which the first meets again and throws after
      // it, slower than it. With e = 0 all three stay together.
      const double heavy = speed * (m0 - m1) / (m0 + m1),
                   v2 = restitution > 0 ? 2 * m0 * speed / (m0 + m1) : m0 * speed / (m0 + m1 + m2);
      const double v1 = restitution > 0 ? 2 * m0 * heavy / (m0 + m1) : v2;
      const double v0 = restitution > 0 ? heavy * (m0 - m1) / (m0 + m1) : v2;
      const int refused = try_steps(1e-3, 0.25, 1.5, scene, [&](const Ended& ended) {
        CHECK(ended.velocity(0)[0] == doctest::Approx(v0).epsilon(1e-9));
        CHECK(ended.velocity(1)[0] == doctest::Approx(v1).epsilon(1e-9));
        CHECK(ended.velocity(2)[0] == doctest::Approx(v2).epsilon(1e-9));
      });
      if (restitution > 0) CHECK(refused > 0);
    }
}

TEST_CASE("passages: the path to the end of the last step is followed, and the step is not taken") {
  // Perfect restitution: contacts act once they touch. At q_m of the second step disk 0 is 0.1 m before disk 1.
  const double h = 0.1, speed = 30;
  Simulation s = simulation_of({{.velocity_x = speed}, {.x = 1 + 1.5 * speed * h + 0.1}}, free_flight(1, h));
  Simulation short_one = s;
  s.dynamics.time.steps = 2;
  const RunOutcome outcome = run_simulation(s, {});
  CHECK(outcome.end == RunEnd::broke_down);
  CHECK(outcome.reason.find("step 2: dynamics.step: expected at most ") == 0);
  CHECK(s.state.step == 1);
  CHECK(s.state.x[0] == doctest::Approx(speed * h).epsilon(1e-14));
  short_one.dynamics.time.steps = 1;  // ends before they meet
  CHECK(run_simulation(short_one, {}).end == RunEnd::completed);
}

TEST_CASE("passages: a run that goes on from a state ends as in one piece") {
  const double speed = 30;
  for (const double h : {0.02, 0.035, 0.1}) {
    CAPTURE(h);
    const Simulation start = simulation_of({{.velocity_x = speed}, {.x = 8, .y = 0.7}}, free_flight(0.5, h));
    Simulation whole = start;
    whole.dynamics.time.steps = 8;
    const RunOutcome outcome = run_simulation(whole, {});
    Simulation part = start;
    for (part.dynamics.time.steps = 1; part.dynamics.time.steps <= 8; ++part.dynamics.time.steps) {
      const RunOutcome ended = run_simulation(part, {});
      if (ended.end != RunEnd::broke_down) continue;
      CHECK(ended.reason == outcome.reason);
      break;
    }
    CHECK(part.state.step == whole.state.step);
    CHECK(part.state.x == whole.state.x);
    CHECK(part.state.velocity_y == whole.state.velocity_y);
  }
}

TEST_CASE("passages: what nothing meets is accepted as ever, and relative motion counts") {
  const auto unchanged = [](const std::vector<Grain>& grains, double step, double restitution) {
    Simulation s = simulation_of(grains, free_flight(restitution, step));
    s.dynamics.time.steps = 5;
    CHECK(refusal_of(s) == "");
    for (std::size_t i = 0; i < grains.size(); ++i) {
      CHECK(s.state.velocity_x[i] == doctest::Approx(grains[i].velocity_x).epsilon(1e-12));
      CHECK(std::abs(s.state.velocity_y[i] - grains[i].velocity_y) < 1e-12);
    }
  };
  for (const double restitution : {0.0, 1.0}) {
    std::vector<Grain> packing;  // flies as one, by nine radii in a step
    for (int k = 0; k < 25; ++k)
      packing.push_back({.x = k % 5 * 1.0, .y = k / 5 * 1.0, .velocity_x = 450, .velocity_y = -30});
    unchanged(packing, 0.01, restitution);
    unchanged({{.velocity_x = 450}}, 0.01, restitution);
    unchanged({{.velocity_x = -450}, {.x = 1}}, 0.01, restitution);  // leaves
    unchanged({{.velocity_x = -450}, {.x = 0.75}}, 0.01, 1);         // leaves, from an overlap
    unchanged({{.velocity_x = 450}, {.x = 100, .velocity_x = -450}}, 0.01, restitution);
    unchanged({{.velocity_x = 450}, {.x = 3, .y = 1.001}}, 0.01, 1);       // flies past
    unchanged({{.velocity_x = 450}, {.x = 2.5, .y = 1 - 1e-4}}, 0.01, 1);  // grazes by less than is a contact
  }
}

TEST_CASE("passages: overlaps of the packing itself are told from those that a step makes") {
  const auto refusal = [](const std::vector<Grain>& grains, double step) {
    return run_for(simulation_of(grains, free_flight()), step, 5 * step).refusal;
  };
  const std::string packing = "disk 0 and disk 1: expected an overlap of at most 0.5";
  CHECK(refusal({{}, {.x = 0.6}}, 0.01).find(packing) == 0);
  CHECK(refusal({{.velocity_x = 20}, {.x = 0.74}}, 0.01).find(packing) == 0);
  CHECK(refusal({{.velocity_x = 20}, {.x = 0.8}}, 0.01).find("dynamics.step: expected at most 0.0025 s, met 0.01 s") ==
        0);
  CHECK(refusal({{.velocity_x = 2}, {.x = 0.755}}, 0.01).find("dynamics.step: expected at most ") == 0);
  CHECK(refusal({{.velocity_x = 2}, {.x = 0.8}}, 0.01) == "");
}

TEST_CASE("passages: without restitution grains that miss each other are no contact, however fast they are") {
  for (const double speed : {40.0, 130.0, 400.0})
    for (const double clearance : {1e-3, 0.2, 0.5}) {
      INFO("speed = ", speed, ", clearance = ", clearance);
      Simulation s = simulation_of({{.x = -6.3, .radius = 0.5, .velocity_x = speed},
                                    {.x = 6.3, .y = 1 + clearance, .radius = 0.5, .velocity_x = -speed}},
                                   free_flight(0, 0.01));
      s.dynamics.time.steps = 8;
      CHECK(run_simulation(s, {}).reason == "");
      CHECK(s.state.velocity_x[0] == speed);
      CHECK(s.state.velocity_x[1] == -speed);
      CHECK(s.state.velocity_y[0] == 0);
    }
}

// A plastic impact without friction takes the relative velocity along the line of centres at the meeting, at once.
TEST_CASE("passages: an oblique impact within a long step has the direction of the meeting") {
  int hit = 0;
  for (int k = 0; k < 60; ++k) {
    const double speed = 20 + 5 * (k % 7), offset = -0.9 + 0.03 * k, start = -3.1 - 0.11 * (k % 5);
    CAPTURE(k);
    Simulation s = simulation_of({{.x = start, .radius = 0.5, .velocity_x = speed}, {.y = offset, .radius = 0.5}},
                                 free_flight(0, 0.02));
    s.dynamics.time.steps = 15;
    try {
      if (run_simulation(s, {}).end == RunEnd::broke_down) continue;
    } catch (const Error&) {
      continue;  // the step is too long
    }
    ++hit;
    const double along = std::sqrt(1 - offset * offset);  // of the line of centres where they meet, from 0 to 1
    const double m0 = s.system.mass[0], m1 = s.system.mass[1];
    const double impulse = m0 * m1 / (m0 + m1) * speed * along;
    // The normal may be off by 0.1 rad; the program had 0.4 of the speed.
    CHECK(std::abs(s.state.velocity_x[1] - impulse / m1 * along) < 0.1 * speed);
    CHECK(std::abs(s.state.velocity_y[1] - impulse / m1 * offset) < 0.1 * speed);
  }
  CHECK(hit > 20);
}
