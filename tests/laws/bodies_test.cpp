// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies with contactors in the plane: clumps, planks and walls, free along some directions, against closed forms.
#include "../support/dense.hpp"
#include "../support/granular.hpp"
#include "linalg/random.hpp"
#include "simulation/contact_solver_step.hpp"

#include <doctest/doctest.h>

#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// The boundary as a body that is free along y alone.
BoundarySpec free_along_y(BoundarySpec spec, double mass, const Motion& load = {}) {
  spec.body = free_body(mass, 0, {false, true});
  spec.body->load = load;
  return spec;
}

BoundarySpec shaped(BoundaryShape shape, BoundarySpec spec) {
  spec.shape = shape;
  spec.side = CylinderSide::outside;
  spec.spacing = 2;
  return spec;
}

// The shape of a boundary as another one of a body.
BoundarySpec part_of(const std::string& body, BoundarySpec spec) {
  spec.name = body;
  spec.part = true;
  return spec;
}

// Solved to rounding by sweeps, else to 1e-10.
Dynamics tight_by(Choice<StepAlgorithm> algorithm, const std::vector<BoundarySpec>& boundaries) {
  Dynamics dynamics = tight(boundaries);
  dynamics.solver.algorithm = algorithm;
  if (!has_part(algorithm, StepPart::sweeps)) dynamics.solver.tolerance = 1e-10;
  return dynamics;
}

const RigidVelocity& velocity_of(const Simulation& simulation, std::size_t boundary = 0) {
  return simulation.state.body_velocities[boundary];
}

// Two clumps of three disks each that come to each other, in a box of nothing.
Simulation two_clumps(Choice<StepAlgorithm> algorithm, double friction, std::array<Index, 2> grid = {1, 1}) {
  const std::vector<Grain> grains{{.x = 0, .y = 0},     {.x = 0.8, .y = 0.1}, {.x = 0.3, .y = 0.9},
                                  {.x = 2.0, .y = 0.5}, {.x = 2.7, .y = 0.9}, {.x = 2.5, .y = -0.2}};
  Dynamics dynamics = without_gravity(
      {clump("left", 0, 2, {0.4, 0.3}, 2, 0.5, {1, 0.2, 3}), clump("right", 3, 5, {2.4, 0.4}, 3, 0.9, {-1, 0, -1})});
  dynamics.interaction.friction = friction;
  dynamics.solver.algorithm = algorithm;
  if (has_part(algorithm, StepPart::exchanges)) dynamics.solver.gluing_tolerance = 1e-12;
  return simulation_of(grains, dynamics, grid);
}

struct Momentum {
  double x = 0, y = 0, angular = 0;
};
Momentum momentum_of(const Simulation& simulation) {
  Momentum sum;
  for (const Index k : simulation.system.free_bodies) {
    const FreeBody& body = *simulation.system.boundaries[at(k)].body;
    const Pose& pose = simulation.state.poses[at(k)];
    const RigidVelocity& v = simulation.state.body_velocities[at(k)];
    sum.x += body.mass * v.x;
    sum.y += body.mass * v.y;
    sum.angular += body.inertia[2] * v.spin + body.mass * (pose.x * v.y - pose.y * v.x);
  }
  return sum;
}

}  // namespace

TEST_CASE("a clump flies on a parabola and turns about its centre; its disks are carried") {
  Dynamics dynamics = tight({clump("clump", 0, 1, {1, 2}, 3, 0.7, {2, 5, 4})});
  dynamics.time.step = 0.01;
  Simulation simulation = simulation_of({{.x = 0.4, .y = 2}, {.x = 1.6, .y = 2}}, dynamics);
  const StepReport report = advance(simulation, 20);
  constexpr double t = 0.2;
  const Pose& pose = simulation.state.poses[0];
  CHECK(pose.x == doctest::Approx(1 + 2 * t).epsilon(1e-13));
  CHECK(pose.y == doctest::Approx(2 + 5 * t - g * t * t / 2).epsilon(1e-13));
  CHECK(pose.angle == doctest::Approx(4 * t).epsilon(1e-13));
  CHECK(simulation.state.x[1] == doctest::Approx(pose.x + 0.6 * std::cos(4 * t)).epsilon(1e-13));
  CHECK(simulation.state.y[0] == doctest::Approx(pose.y - 0.6 * std::sin(4 * t)).epsilon(1e-13));
  CHECK(report.energy.kinetic == doctest::Approx(1.5 * (4 + std::pow(5 - g * t, 2)) + 0.35 * 16).epsilon(1e-13));
  CHECK(std::abs(report.energy.numerical) < 1e-12);
}

TEST_CASE("a clump hits the floor beside its centre: the impulse of a rigid body") {
  // Two disks at (-a, 0) and (a, 0); the one at +a is larger and hits alone, its lever is (a, -R).
  constexpr double a = 0.6, radius = 0.5, mass = 2, inertia = 0.3, e = 0.6, v = -3, u = 1.5;
  for (const double friction : {0.0, 0.1, 10.0}) {
    CAPTURE(friction);
    Dynamics dynamics = without_gravity({floor_wall(), clump("clump", 0, 1, {0, 0.5}, mass, inertia, {u, v, 0.4})});
    dynamics.time.step = 1e-8;  // the lever turns by half a step
    dynamics.interaction.friction = friction;
    dynamics.interaction.restitution = e;
    Simulation simulation = simulation_of({{.x = -a, .y = 0.5, .radius = 0.2}, {.x = a, .y = 0.5}}, dynamics);
    const StepReport report = advance(simulation);
    // v_n = v + a w, v_t = u + R w on the body; W from levers.
    const double w = 0.4, normal = v + a * w, tangential = u + radius * w;
    const double nn = 1 / mass + a * a / inertia, nt = a * radius / inertia, tt = 1 / mass + radius * radius / inertia;
    const double determinant = nn * tt - nt * nt, to_n = -(1 + e) * normal, to_t = -tangential;
    double n = (tt * to_n - nt * to_t) / determinant, t = (nn * to_t - nt * to_n) / determinant;
    if (std::abs(t) > friction * n) {  // slides: t = -friction n, for it slides forward
      n = to_n / (nn - friction * nt);
      t = -friction * n;
    }
    CHECK(velocity_of(simulation, 1).x == doctest::Approx(u + t / mass).epsilon(1e-6));
    CHECK(velocity_of(simulation, 1).y == doctest::Approx(v + n / mass).epsilon(1e-6));
    CHECK(velocity_of(simulation, 1).spin == doctest::Approx(w + (a * n + radius * t) / inertia).epsilon(1e-6));
    CHECK(std::abs(report.energy.numerical) < 1e-6);
  }
}

TEST_CASE("a disk with any inertia rolls down a slope at g sin(alpha) / (1 + I/(m R^2))") {
  constexpr double alpha = 0.3, radius = 0.5, mass = 2;
  const double c = std::cos(alpha), s = std::sin(alpha);
  for (const double inertia : {0.05, 0.25, 0.45}) {  // 0.25 is a full disk
    Dynamics dynamics =
        tight({wall("slope", {0, 0}, {c, -s}), clump("wheel", 0, 0, {radius * s, radius * c}, mass, inertia)});
    dynamics.boundaries[0].to = {c, -s};
    dynamics.interaction.friction = 2;
    dynamics.time.step = 1e-3;
    Simulation simulation = simulation_of({{.x = radius * s, .y = radius * c}}, dynamics);
    advance(simulation, 50);
    const double speed = g * s / (1 + inertia / (mass * radius * radius)) * 0.05;
    CHECK(velocity_of(simulation, 1).x * c - velocity_of(simulation, 1).y * s == doctest::Approx(speed).epsilon(1e-9));
    CHECK(velocity_of(simulation, 1).spin == doctest::Approx(-speed / radius).epsilon(1e-9));
  }
}

TEST_CASE("a wall that is free along y and pushed down compresses a column: reactions are forces and weights") {
  constexpr double force = 30, mass = 4;
  for (const StepAlgorithm algorithm : {StepAlgorithm::nlgs, StepAlgorithm::automatic}) {
    const BoundarySpec top = free_along_y(wall("top", {1, 3}, {0, 3}), mass, moving({.y = -force}));
    const Dynamics dynamics = tight_by(algorithm, {floor_wall(), top});
    Simulation simulation = simulation_of({{.y = 0.5}, {.y = 1.5}, {.y = 2.5}}, dynamics);
    const StepReport report = advance(simulation, 5);
    const double h = dynamics.time.step, weight = mass * g;
    CHECK(impulse_between(simulation.state, 2, 4).n / h == doctest::Approx(force + weight).epsilon(1e-7));
    CHECK(impulse_between(simulation.state, 0, 3).n / h == doctest::Approx(force + weight + 3 * g).epsilon(1e-7));
    CHECK(std::abs(velocity_of(simulation, 1).y) < 1e-7);
    CHECK(velocity_of(simulation, 1).x == 0);
    CHECK(std::abs(report.energy.boundary_work) < 1e-6);
  }
}

TEST_CASE("a wall without contacts falls by its load, which may depend on time, and does its work") {
  BoundarySpec top = free_along_y(wall("top", {1, 3}, {0, 3}), 2);
  top.body->load.oscillations = {{{.y = -6}, 0, 0, 0, 5}};  // 0 ... -6 N in 0.2 s
  Dynamics dynamics = without_gravity({top});
  dynamics.time.step = 0.01;
  Simulation simulation = simulation_of({{.y = 0.5}}, dynamics);
  double work = 0;
  for (Index k = 0; k < 20; ++k) work += advance(simulation).energy.boundary_work;
  CHECK(velocity_of(simulation).y == doctest::Approx(-6 * 0.2 / 2 / 2).epsilon(1e-12));
  CHECK(work == doctest::Approx(2 * std::pow(velocity_of(simulation).y, 2) / 2).epsilon(1e-12));
  CHECK(simulation.state.poses[0].y == doctest::Approx(-6 * 5 * std::pow(0.2, 3) / 6 / 2).epsilon(2e-3));
}

TEST_CASE("a disk meets the end of a plank along the line to its centre, from any side") {
  for (const double angle : {-0.4, 0.0, 0.7, 1.2, std::numbers::pi / 2}) {
    // The end at (1, 0), thickness 0.2; the disk comes along the line at `angle`, seen from the end.
    const double reach = 0.1 + 0.5 + 1e-4, c = std::cos(angle), s = std::sin(angle);
    Dynamics dynamics = without_gravity({plank("plank", {-1, 0}, {1, 0}, 0.1)});
    dynamics.interaction.restitution = 1;
    dynamics.interaction.friction = 0;
    const Grain disk{.x = 1 + reach * c, .y = reach * s, .velocity_x = -c, .velocity_y = -s};
    Simulation simulation = simulation_of({disk}, dynamics);
    advance(simulation, 3);
    CAPTURE(angle);
    CHECK(simulation.state.velocity_x[0] == doctest::Approx(c).scale(1).epsilon(1e-12));
    CHECK(simulation.state.velocity_y[0] == doctest::Approx(s).scale(1).epsilon(1e-12));
  }
}

TEST_CASE("a plank holds a disk from above and from below, and none beyond its end") {
  Dynamics dynamics = tight({plank("plank", {-1, 0}, {1, 0}, 0.1)});
  Simulation above = simulation_of({{.x = 0.9, .y = 0.6}, {.x = 2.5, .y = 0.6}}, dynamics);
  advance(above, 10);
  CHECK(std::abs(above.state.velocity_y[0]) < 1e-12);
  CHECK(above.state.velocity_y[1] == doctest::Approx(-10 * dynamics.time.step * g).epsilon(1e-12));
  dynamics.time.gravity = {0, 9.81};
  Simulation below = simulation_of({{.x = 0.9, .y = -0.6}}, dynamics);
  advance(below, 10);
  CHECK(std::abs(below.state.velocity_y[0]) < 1e-12);
}

TEST_CASE("planks, a cylinder and disks that are one driven body move grains as single bodies do, bit for bit") {
  const auto run = [](bool one) {
    std::vector<BoundarySpec> box{plank("0", {0, 0}, {4, 0}, 0.1), plank("1", {4, 0}, {4, 4}, 0.1),
                                  wall("2", {4, 4}, {0, 4}),
                                  shaped(BoundaryShape::disks, plank("3", {0, 0}, {0, 4}, 0.8)),
                                  shaped(BoundaryShape::cylinder, plank("4", {1.5, 2}, {}, 0.1))};
    for (BoundarySpec& each : box) {
      each.motion = moving({.x = 0.5, .y = 0.1, .spin = 2}, {2, 2});
      if (one && each.name != "0") each = part_of("0", each);
    }
    Simulation simulation = simulation_of({{.x = 1, .y = 1}, {.x = 2.1, .y = 1.2}, {.x = 2, .y = 2.5}}, tight(box));
    advance(simulation, 60);
    CHECK(simulation.system.boundaries.size() == (one ? 1 : 5));
    return simulation.state;
  };
  const GranularState one = run(true), five = run(false);
  CHECK(one.impulses.size() > 2);
  CHECK(one.x == five.x);
  CHECK(one.y == five.y);
  CHECK(one.spin == five.spin);
}

TEST_CASE("a free body of a plank and two disks carries a disk on two supports: reactions by the rule of the lever") {
  constexpr double mass = 3, centre = 0.1, left = -0.8, right = 0.6, load = 0.3;
  for (const StepAlgorithm algorithm : {StepAlgorithm::nlgs, StepAlgorithm::automatic}) {
    BoundarySpec beam = plank("beam", {-1, 0}, {1, 0}, 0.1);
    beam.motion.centre = {centre, 0, 0};
    beam.body = free_body(mass, 0.5);
    // The row of one disk at each end of the plank, and grain 0 above the centre, under the load.
    const Dynamics dynamics =
        tight_by(algorithm, {beam, part_of("beam", shaped(BoundaryShape::disks, plank("", {-1, 0}, {1, 0}, 0.1))),
                             part_of("beam", driven_grains("", 0, 0)), driven_grains("supports", 1, 2)});
    Simulation simulation = simulation_of(
        {{.x = load, .y = 0.6}, {.x = left, .y = -0.6}, {.x = right, .y = -0.6}, {.x = load, .y = 1.6}}, dynamics);
    advance(simulation, 3);
    const double h = dynamics.time.step, weight = mass * g, all = weight + g;
    const double on_right = (weight * (centre - left) + g * (load - left)) / (right - left);
    const Index plank_number = simulation.system.grains();
    CHECK(impulse_between(simulation.state, 0, 3).n / h == doctest::Approx(g).epsilon(1e-7));
    CHECK(impulse_between(simulation.state, 2, plank_number).n / h == doctest::Approx(on_right).epsilon(1e-7));
    CHECK(impulse_between(simulation.state, 1, plank_number).n / h == doctest::Approx(all - on_right).epsilon(1e-7));
    CHECK(std::abs(velocity_of(simulation).spin) < 1e-8);
  }
}

TEST_CASE("a disk slides down a tilted plank at g sin(alpha) and leaves it at its end") {
  constexpr double alpha = 0.5;
  const double c = std::cos(alpha), s = std::sin(alpha);
  Dynamics dynamics = tight({plank("plank", {-c, s}, {c, -s}, 0.1)});
  dynamics.interaction.friction = 0;
  dynamics.time.step = 1e-3;
  Simulation simulation = simulation_of({{.x = 0.6 * s, .y = 0.6 * c}}, dynamics);
  while (simulation.state.x[0] * c - simulation.state.y[0] * s < 0.9) advance(simulation);
  const GranularState& state = simulation.state;
  CHECK(state.velocity_x[0] * c - state.velocity_y[0] * s == doctest::Approx(g * s * state.time).epsilon(1e-10));
  while (state.time < 1) advance(simulation);
  CHECK(state.y[0] < -1);  // a wall would hold it on the line
  CHECK(state.y[0] < -std::tan(alpha) * state.x[0] + 0.6 / c - 0.5);
}

TEST_CASE("a disk that is fast goes through no plank unseen") {
  Dynamics dynamics = without_gravity({plank("plank", {-1, 0}, {1, 0}, 0.01)});
  dynamics.interaction.restitution = 0.5;
  dynamics.time.step = 0.01;
  for (const double speed : {200, 400}) {  // in the plank when contacts are found, and beyond it
    CAPTURE(speed);
    Simulation simulation = simulation_of({{.x = 0.2, .y = 1.1, .velocity_y = -speed}}, dynamics);
    CHECK_THROWS_WITH_AS(advance(simulation, 1), doctest::Contains("dynamics.step"), Error);
  }
  // A rod that turns, with a row of disks at its middle, and a small disk on the way of its end.
  BoundarySpec rod = plank("rod", {-2.2, 0}, {2.2, 0}, 0.01);
  rod.motion.initial = RigidVelocity{.spin = 14};
  rod.body = free_body(1, 1);
  dynamics.boundaries = {rod, part_of("rod", shaped(BoundaryShape::disks, plank("", {-0.001, 0}, {0.001, 0}, 0.05)))};
  Simulation simulation = simulation_of({{.x = 2, .y = 0.5, .radius = 0.05}}, dynamics);
  CHECK_THROWS_WITH_AS(advance(simulation, 4), doctest::Contains("dynamics.step"), Error);
}

TEST_CASE("a rough plate that is free along y alone goes down between fixed walls that it touches") {
  constexpr double force = 20, mass = 3;
  const auto end_of = [](Choice<StepAlgorithm> algorithm, bool walls) {
    // Disks 0 to 2 of the bed; 3 to 5 of the plate, whose ends touch the side walls.
    const std::vector<Grain> grains{{.x = 0.5, .y = 0.5}, {.x = 1.5, .y = 0.5}, {.x = 2.5, .y = 0.5},
                                    {.x = 0.5, .y = 1.5}, {.x = 1.5, .y = 1.5}, {.x = 2.5, .y = 1.5}};
    BoundarySpec plate = free_along_y(driven_grains("plate", 3, 5), mass, moving({.y = -force}));
    plate.motion.centre = {1.5, 1.5, 0};
    std::vector<BoundarySpec> boundaries{floor_wall(), plate};
    if (walls) boundaries.insert(boundaries.end(), {wall("left", {0, 1}, {0, 0}), wall("right", {3, 0}, {3, 1})});
    const Dynamics dynamics = tight_by(algorithm, boundaries);
    Simulation simulation = simulation_of(grains, dynamics);
    const StepReport report = advance(simulation, 5);
    CHECK(report.residual.relative_natural_map() < 1e-9);
    CHECK(velocity_of(simulation, 1).x == 0);
    CHECK(std::abs(velocity_of(simulation, 1).y) < 1e-9);
    double sum = 0;  // what the bed carries
    for (Index i = 0; i < 3; ++i) sum += impulse_between(simulation.state, i, 3 + i).n / dynamics.time.step;
    return sum;
  };
  for (const StepAlgorithm algorithm : {StepAlgorithm::nlgs, StepAlgorithm::automatic, StepAlgorithm::generic})
    for (const bool walls : {false, true})
      CHECK(end_of(algorithm, walls) == doctest::Approx(force + mass * g).epsilon(1e-7));
}

TEST_CASE("a wall that is free along y presses driven grains, along which nothing can rub") {
  for (const StepAlgorithm algorithm : {StepAlgorithm::nlgs, StepAlgorithm::automatic}) {
    const BoundarySpec top = free_along_y(wall("top", {1, 1}, {0, 1}), 2);
    const Dynamics dynamics = tight_by(algorithm, {top, driven_grains("stones", 0, 1, moving({.x = 0.3}))});
    Simulation simulation = simulation_of({{.x = 0, .y = 0.5}, {.x = 2, .y = 0.5}, {.x = 9, .y = 0.5}}, dynamics);
    advance(simulation, 3);
    const double sum = impulse_between(simulation.state, 0, 3).n + impulse_between(simulation.state, 1, 3).n;
    CHECK(sum / dynamics.time.step == doctest::Approx(2 * g).epsilon(1e-9));
    CHECK(std::abs(velocity_of(simulation).y) < 1e-10);
  }
}

TEST_CASE("a plate that is free along y alone rubs on no slope: without friction it is held, with it refused") {
  // The slope rises at 45 degrees; the plate is one disk.
  Dynamics dynamics = tight({wall("slope", {0, 0}, {1, 1}), free_along_y(driven_grains("plate", 0, 0), 2)});
  const double touch = 0.5 * std::sqrt(2.0);
  dynamics.interaction.friction = 0;
  Simulation simulation = simulation_of(std::vector<Grain>{{.x = 0, .y = touch}}, dynamics);
  advance(simulation, 5);
  CHECK(std::abs(velocity_of(simulation, 1).y) < 1e-12);
  CHECK(impulse_between(simulation.state, 0, 1).n / dynamics.time.step ==
        doctest::Approx(2 * g * std::sqrt(2.0)).epsilon(1e-9));
  simulation.dynamics.interaction.friction = 0.3;
  CHECK_THROWS_WITH_AS(advance(simulation), doctest::Contains("along the surface independently"), Error);
  // The friction is that of the contact, by its colours.
  dynamics.colours = {{"plate", 0, 0}};
  dynamics.boundaries[0].colour = "slope";
  for (const double friction : {0.0, 0.3}) {
    dynamics.interaction.friction = 0.3 - friction;
    dynamics.pairs = {{{"slope", "plate"}, {.friction = friction}}};
    Simulation coloured = simulation_of(std::vector<Grain>{{.x = 0, .y = touch}}, dynamics);
    if (friction == 0)
      advance(coloured);
    else
      CHECK_THROWS_WITH_AS(advance(coloured), doctest::Contains("along the surface independently"), Error);
  }
}

TEST_CASE("clumps that collide keep momentum and angular momentum, and lose the energy that contacts dissipate") {
  for (const double friction : {0.0, 0.5}) {
    Simulation simulation = two_clumps(StepAlgorithm::nlgs, friction);
    const Momentum before = momentum_of(simulation);
    double met = 0;
    for (Index k = 0; k < 400; ++k) {
      const StepReport report = advance(simulation);
      met = std::max(met, report.energy.dissipation);
      CHECK(report.energy.dissipation > -1e-12);
      CHECK(std::abs(report.energy.numerical) < 1e-11);
    }
    const Momentum after = momentum_of(simulation);
    CHECK(met > 0.1);
    CHECK(after.x == doctest::Approx(before.x).epsilon(1e-12));
    CHECK(after.y == doctest::Approx(before.y).scale(1).epsilon(1e-12));
    // Friction acts at points of both surfaces, which a gap or an overlap parts.
    CHECK(after.angular == doctest::Approx(before.angular).epsilon(friction == 0 ? 1e-11 : 1e-3));
  }
}

TEST_CASE("sweeps, the contact solver and Algorithm 1 in two subdomains find the same velocities of clumps") {
  const auto end_of = [](Choice<StepAlgorithm> algorithm, std::array<Index, 2> grid) {
    Simulation simulation = two_clumps(algorithm, 0.3, grid);
    advance(simulation, 300);
    return simulation.state;
  };
  const GranularState swept = end_of(StepAlgorithm::nlgs, {1, 1});
  CHECK(std::abs(swept.body_velocities[0].x - 1) > 0.1);
  for (const auto& way : {std::pair(StepAlgorithm::automatic, std::array<Index, 2>{1, 1}),
                          {StepAlgorithm::generic, {2, 2}},
                          {StepAlgorithm::enriched, {2, 2}},
                          {StepAlgorithm::schwarz, {2, 2}}}) {
    const GranularState other = end_of(way.first, way.second);
    CAPTURE(to_string(way.first));
    for (std::size_t k = 0; k < 2; ++k) {
      CHECK(other.body_velocities[k].x == doctest::Approx(swept.body_velocities[k].x).epsilon(1e-7));
      CHECK(other.body_velocities[k].y == doctest::Approx(swept.body_velocities[k].y).epsilon(1e-7));
      CHECK(other.body_velocities[k].spin == doctest::Approx(swept.body_velocities[k].spin).epsilon(1e-7));
    }
  }
}

TEST_CASE("W of random bodies is symmetric and positive, and its blocks are those that sweeps use") {
  RandomStream random(5);
  std::vector<Grain> grains;
  std::vector<BoundarySpec> boundaries{floor_wall()};
  for (Index k = 0; k < 12; ++k) {
    const double x = 1.1 * static_cast<double>(k % 4), y = 0.5 + 1.0 * static_cast<double>(k / 4);
    grains.push_back({.x = x, .y = y});
    if (k % 3 == 0)
      boundaries.push_back(clump("body " + std::to_string(k), k, k, {x + 0.2 * random.uniform(), y - 0.1},
                                 1 + random.uniform(), 0.1 + random.uniform()));
  }
  const Simulation simulation = simulation_of(grains, tight(boundaries));
  const StepProblem<2> step = prepare_step<2>(start_of(simulation), false);
  const LocalFrictionProblem problem = contact_problem(step, simulation.system);
  const Matrix w(problem.w);
  REQUIRE(problem.contacts() > 10);
  CHECK((w - w.transpose()).cwiseAbs().maxCoeff() < 1e-13 * w.maxCoeff());
  CHECK(symmetric_eigenvalues(w)[0] > -1e-12 * w.maxCoeff());
  Index coupled = 0;
  for (Index c = 0; c < problem.contacts(); ++c) {
    const FullDelassus<2> block = diagonal_block<2>(problem, c);
    const auto check = [&](const auto& own) {
      for (const LocalVector<2> r : {LocalVector<2>{1, 0}, LocalVector<2>{0, 1}})
        CHECK(norm(own.apply(r).n - block.apply(r).n) + norm(own.apply(r).t - block.apply(r).t) < 1e-12);
    };
    with_delassus(step.contacts[at(c)], check);
    coupled += std::abs(block.nt) > 0.01;
  }
  CHECK(coupled > 3);
}

TEST_CASE("bodies that cannot move as a case says are refused") {
  const auto refused = [](const BoundarySpec& spec, const char* words) {
    CAPTURE(words);
    CHECK_THROWS_WITH_AS(simulation_of({{.y = 0.5}, {.y = 2}}, tight({spec})), doctest::Contains(words), Error);
  };
  BoundarySpec one = clump("body", 1, 1, {0, 2}, 1, 0.1);
  one.body->mass = 0;
  refused(one, "expected a finite mass > 0");
  one = clump("body", 1, 1, {0, 2}, 1, 0);
  refused(one, "moments of inertia > 0");
  one = clump("body", 1, 1, {0, 2}, 1, 0.1);
  one.motion.time = {0};
  one.motion.velocity = {{.x = 1}};
  refused(one, "free or driven, met x as both");
  one.body->directions = {false, true};
  one.body->load.time = {0};
  one.body->load.velocity = {{.x = 2}};
  refused(one, "forces along free directions, met one along x");
  one.body->directions = {};
  one.body->load = {};
  refused(one, "expected a free direction");
  one = clump("body", 1, 1, {0, 2}, 1, 0.1);
  one.body->directions[2] = true;
  refused(one, "in the plane, met z");
}
