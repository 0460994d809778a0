// SPDX-License-Identifier: GPL-3.0-or-later
// Periodic cells: near pairs against all pairs, and a cell whose beginning lies elsewhere.
#include "../support/spheres.hpp"
#include "linalg/random.hpp"
#include "packing/grain_grid.hpp"

#include <doctest/doctest.h>

#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Simulation in_cell(const std::vector<Grain>& grains, const Dynamics& dynamics, double period) {
  return simulation_of(grains, dynamics, {1, 1}, {.x = period});
}

// Disks that fall on a floor, in a cell of 5 m.
std::vector<Grain> rain(double shift) {
  RandomStream random(11);
  std::vector<Grain> grains;
  for (Index k = 0; k < 20; ++k) {
    const double x = 1.2 * static_cast<double>(k % 4) + 0.1 * random.uniform() + shift;
    grains.push_back({.x = x - 5 * std::floor(x / 5),
                      .y = 0.55 + 1.1 * static_cast<double>(k / 4),
                      .velocity_x = random.uniform() - 0.5,
                      .velocity_y = random.uniform() - 1});
  }
  return grains;
}

}  // namespace

TEST_CASE("near pairs of a periodic cell are those of all pairs by their shortest vectors, each once") {
  for (const bool space : {false, true})
    for (const Period period : {Period{6, 0}, Period{0, 5}, Period{6, 5}})
      for (const double range : {0.1, 3.5}) {
        RandomStream random(3);
        std::vector<double> x, y, z, radius;
        for (Index i = 0; i < 60; ++i) {
          x.push_back(30 * random.uniform() - 15);  // images of the cell, too
          y.push_back(20 * random.uniform() - 10);
          if (space) z.push_back(4 * random.uniform());
          radius.push_back(0.2 + 0.8 * random.uniform());
        }
        std::set<std::array<Index, 2>> found;
        Index visits = 0;
        const auto distance = [&](Index i, Index j) {
          const auto d = period.shortest({x[at(j)] - x[at(i)], y[at(j)] - y[at(i)], space ? z[at(j)] - z[at(i)] : 0});
          return std::hypot(d[0], d[1], d[2]);
        };
        for_each_near_pair({x, y, z}, radius, period, 1, range, [&](Index i, Index j) {
          REQUIRE(i < j);
          if (distance(i, j) > radius[at(i)] + radius[at(j)] + range) return;
          found.insert({i, j});
          ++visits;
        });
        std::set<std::array<Index, 2>> expected;
        for (Index i = 0; i < 60; ++i)
          for (Index j = i + 1; j < 60; ++j)
            if (distance(i, j) <= radius[at(i)] + radius[at(j)] + range) expected.insert({i, j});
        INFO("space = ", space, ", period = ", period.x, ", range = ", range);
        CHECK(found == expected);
        CHECK(visits == count(expected));
      }
}

TEST_CASE("two grains of a short cell have one contact, though they are in reach of each other at both ends") {
  Dynamics dynamics = tight();
  dynamics.time.alert = 0.5;
  const Simulation simulation = in_cell({{.x = 0.1}, {.x = 1.1}}, dynamics, 2.1);
  const StepProblem<2> problem = prepare_step<2>(start_of(simulation), false);
  REQUIRE(problem.geometry.size() == 1);
  CHECK(problem.geometry[0].normal[0] == doctest::Approx(1));
}

TEST_CASE("a closed row and a closed lattice of touching disks have contacts across the ends of the cell") {
  Packing row;
  for (Index k = 0; k < 5; ++k) row.x.push_back(0.5 + static_cast<double>(k));
  row.y.assign(5, 0.0);
  row.radius.assign(5, 0.5);
  CHECK(detect_contacts(row).size() == 4);
  const ContactNetwork closed = detect_contacts(row, {.period_x = 5});
  REQUIRE(closed.size() == 5);
  CHECK(closed.contacts[1].a == 0);
  CHECK(closed.contacts[1].b == 4);
  CHECK(closed.contacts[1].normal == std::array<double, 3>{-1, 0, 0});
  CHECK(std::abs(closed.contacts[1].midpoint[0]) < 1e-15);
  Packing lattice;
  const double height = std::sqrt(3.0) / 2;
  for (Index r = 0; r < 4; ++r)
    for (Index c = 0; c < 6; ++c) {
      lattice.x.push_back(static_cast<double>(c) + 0.5 * static_cast<double>(r % 2));
      lattice.y.push_back(height * static_cast<double>(r));
      lattice.radius.push_back(0.5);
    }
  CHECK(detect_contacts(lattice, {.period_x = 6, .period_y = 4 * height}).size() == 3 * 24);
  CHECK_THROWS_WITH_AS(detect_contacts(row, {.period_x = 1.9}), doctest::Contains("two diameters"), Error);
  // At two diameters two disks touch at both ends, within the tolerance also a little above.
  row.x = {0, 1}, row.y = {0, 0}, row.radius = {0.5, 0.5};
  CHECK_THROWS_WITH_AS(detect_contacts(row, {.period_x = 2}), doctest::Contains("two diameters"), Error);
  CHECK_THROWS_WITH_AS(detect_contacts(row, {.tolerance = 0.5, .period_x = 2.4}), doctest::Contains("met 2.4"), Error);
  row.mass = {1, 1};  // velocities of a deformation jump at the end of the cell
  for (const Loads& loads : {Loads{.compression = {1, 0}}, Loads{.compression = {0, 0}, .shear = 1}})
    CHECK_THROWS_WITH_AS(assemble(row, detect_contacts(row, {.period_x = 3}), {}, loads),
                         doctest::Contains("contacts.period_x"), Error);
  CHECK_NOTHROW(assemble(row, detect_contacts(row, {.period_x = 3}), {}, {.compression = {0, 1}}));
}

TEST_CASE("disks move in the same way wherever their cell begins, and stay in it") {
  Dynamics dynamics = tight({floor_wall()});
  dynamics.interaction.friction = 0.2;
  Simulation here = in_cell(rain(0), dynamics, 5), there = in_cell(rain(1.7), dynamics, 5);
  double across = 0;
  for (Index k = 0; k < 60; ++k) {
    advance(here);
    advance(there);
    for (std::size_t i = 0; i < 20; ++i) {
      CHECK(there.state.velocity_x[i] == doctest::Approx(here.state.velocity_x[i]).scale(1).epsilon(1e-7));
      CHECK(there.state.velocity_y[i] == doctest::Approx(here.state.velocity_y[i]).scale(1).epsilon(1e-7));
      const double moved = there.state.x[i] - here.state.x[i] - 1.7;
      CHECK(std::abs(moved - 5 * std::round(moved / 5)) < 1e-7);
      CHECK(there.state.x[i] >= 0);
      CHECK(there.state.x[i] < 5);
    }
    for (const RememberedImpulse& one : here.state.impulses)
      if (one.b < 20 && std::abs(here.state.x[at(one.a)] - here.state.x[at(one.b)]) > 2.5)
        across = std::max(across, one.impulse[0]);
  }
  CHECK(across > 0.01);  // some of the impulses go across the ends
  const Simulation open = simulation_of(rain(0), dynamics);
  CHECK(open.system.period.any() == false);
}

TEST_CASE("a clump leaves a cell at one end and enters it at the other, with its disks") {
  const Dynamics dynamics = without_gravity({clump("clump", 0, 1, {4.5, 0}, 1, 1, {.x = 2})}, 0.005);
  Simulation simulation = in_cell({{.x = 4.2}, {.x = 4.8}}, dynamics, 5);
  advance(simulation, 100);
  CHECK(simulation.state.poses[0].x == doctest::Approx(4.5 + 2 * 0.5 - 5).epsilon(1e-12));
  CHECK(simulation.state.x[1] - simulation.state.x[0] == doctest::Approx(0.6).epsilon(1e-12));
  CHECK(simulation.state.x[0] == doctest::Approx(simulation.state.poses[0].x - 0.3).epsilon(1e-12));
}

TEST_CASE("a layer that is sheared in a periodic cell rolls at half the speed of its plate, or slides until it does") {
  // The plate is pressed on the layer, and moves on, in space askew to a cell that is periodic in x and y.
  constexpr double speed = 0.8, load = 8000, h = 1e-3, mass = 2;
  constexpr int steps = 3000;
  for (const bool space : {false, true})
    for (const double friction : {1.0, 0.01}) {
      INFO("space = ", space, ", friction = ", friction);
      const Vector3 up = space ? Vector3(0, 0, 1) : Vector3(0, 1, 0), along(space ? 0.6 : 1, space ? 0.8 : 0, 0);
      BoundarySpec top = space ? plane("top", up, -up) : wall("top", {1, 1}, {0, 1});
      top.motion = moving_in_space(speed * along, Vector3::Zero());
      top.body.emplace().directions[space ? 2 : 1] = true;
      top.body->mass = 3;
      top.body->load = moving_in_space(-load * up, Vector3::Zero());
      Dynamics dynamics = tight({space ? plane("floor", Vector3::Zero(), up) : floor_wall(), top});
      dynamics.time.gravity = {0, 0, 0};
      dynamics.time.step = h;
      dynamics.interaction.friction = friction;
      if (space) dynamics.solver.algorithm = "generic";  // the plate is shared
      Packing layer{{0.5, 1.7, 3.4}, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {mass, mass, mass}, {}};
      if (space) std::tie(layer.y, layer.z) = std::pair(std::vector{0.6, 1.9, 3.4}, layer.y);
      const GranularScene made = scene(layer, dynamics, {.x = 4, .y = space ? 4.0 : 0.0});
      Simulation simulation{made.system, made.state, dynamics, GridPartitioner{{2, 1, 1}}};
      const GranularState& state = simulation.state;
      const auto v = [&](std::size_t i) { return along[0] * state.velocity_x[i] + along[1] * state.velocity_y[i]; };
      const auto step = [&] { return space ? advance_in_space(simulation) : advance(simulation); };
      const double c = space ? 0.4 : 0.5;  // the inertia is c m R^2
      if (friction == 1) {
        // p_top + p_floor = m v and p_top - p_floor = c m v, v = speed / 2, on each grain; half of the work is lost.
        const double work = 3 * (1 + c) / 4 * mass * speed * speed;
        const StepReport first = step();
        CHECK(first.energy.boundary_work == doctest::Approx(work).epsilon(1e-9));
        CHECK(first.energy.dissipation == doctest::Approx(work / 2).epsilon(1e-9));
      } else {  // slides on the plate, rolls on the floor: v = 2 p_top / (m (1 + c)), of all grains together
        for (int k = 1; k <= 5; ++k) {
          step();
          CHECK(v(0) + v(1) + v(2) == doctest::Approx(2 * friction * load * h * k / (mass * (1 + c))).epsilon(1e-9));
        }
        for (int k = 0; k < 60; ++k) step();
      }
      const GranularState before = state;
      for (int k = 0; k < steps; ++k) {
        const StepReport report = step();
        CHECK(report.contacts == 6);
        CHECK(std::abs(report.energy.dissipation) < 1e-9);
      }
      const double way = speed / 2 * steps * h;
      CHECK(state.x[2] < 1);  // it left the cell at the end
      for (std::size_t i = 0; i < 3; ++i) {
        CHECK(v(i) == doctest::Approx(speed / 2).epsilon(1e-9));
        CHECK(std::abs(along[0] * state.velocity_y[i] - along[1] * state.velocity_x[i]) < 1e-9);
        CHECK(state.x[i] == doctest::Approx(before.x[i] + along[0] * way - (i == 2 ? 4 : 0)).epsilon(1e-9));
        CHECK(state.y[i] == doctest::Approx(before.y[i] + along[1] * way - (space && i == 2 ? 4 : 0)).epsilon(1e-9));
      }
    }
}

TEST_CASE("a plank holds grains beyond the ends of its cell, and a chute keeps the energy balance") {
  for (const double middle : {2.5, 5.0, 0.1}) {
    const double x = middle + 0.5;
    const Dynamics dynamics = tight({plank("plank", {middle - 0.8, 0}, {middle + 0.8, 0}, 0.1)});
    Simulation simulation = in_cell({{.x = x - 5 * std::floor(x / 5), .y = 0.6}}, dynamics, 5);
    advance(simulation, 10);
    CHECK(std::abs(simulation.state.velocity_y[0]) < 1e-12);
  }
  Dynamics chute = tight({floor_wall()});
  chute.time.gravity = {10, -10};
  chute.interaction.friction = 0;
  Simulation simulation = in_cell({{.x = 4.5, .y = 0.5, .velocity_x = 3}}, chute, 5);
  double numerical = 0;
  for (Index k = 0; k < 100; ++k) numerical += advance(simulation).energy.numerical;
  CHECK(simulation.state.velocity_x[0] == doctest::Approx(3 + 10 * 0.5).epsilon(1e-12));
  CHECK(std::abs(numerical) < 1e-10);
}

TEST_CASE("the grains of a clump are beside its centre, and no clump meets itself") {
  const auto clump_in_cell = [](double period, std::vector<Grain> grains) {
    return in_cell(grains, tight({clump("clump", 0, -1, {4.9, 0}, 1, 1)}), period);
  };
  const Simulation simulation = clump_in_cell(5, {{.x = 4.7}, {.x = 0.1}});  // 0.2 and 0.2 from the centre
  CHECK(simulation.state.x[1] == doctest::Approx(5.1).epsilon(1e-14));
  CHECK(simulation.system.boundaries[0].body->reach == doctest::Approx(0.7).epsilon(1e-12));
  CHECK_THROWS_WITH_AS(clump_in_cell(2.2, {{.x = 4.2}, {.x = 4.9}, {.x = 5.6}}),
                       doctest::Contains("shorter than the periodic cell"), Error);
}

TEST_CASE("a raft that does not turn is as long as its cell, and carries disks wherever its images are") {
  // A row of five disks, loaded by the weight of all, that is pulled along x. The images of the disks that are nearest
  // to its centre, x = 1, are -1.5, -0.5, 0.5, 1.5 and 2.5.
  const double weight = (2 + 2) * g, speed = 0.3;
  Dynamics dynamics = tight({driven_grains("raft", 0, 4, moving({.x = speed}, {1, 0}))});
  dynamics.interaction.friction = 0;
  FreeBody& body = dynamics.boundaries[0].body.emplace();
  body.directions = {false, true, false, false, false, false};
  body.mass = 2;
  body.load = moving({.y = weight});
  std::vector<Grain> grains;
  for (int k = 0; k < 5; ++k) grains.push_back({.x = 0.5 + k});
  for (const double x : {0.0, 3.0}) grains.push_back({.x = x, .y = std::sqrt(0.75), .velocity_x = speed});
  Simulation simulation = in_cell(grains, dynamics, 5);
  for (Index k = 0; k < 400; ++k) {  // the raft leaves the cell at one end and enters it at the other
    CHECK(advance(simulation).contacts == 4);
    for (const std::size_t disk : {5U, 6U}) CHECK(std::abs(simulation.state.velocity_y[disk]) < 1e-9);
    CHECK(std::abs(simulation.state.body_velocities[0].y) < 1e-9);
  }
  body.directions[5] = true;
  body.inertia[2] = 1;
  CHECK_THROWS_WITH_AS(in_cell(grains, dynamics, 5), doctest::Contains("shorter than the periodic cell"), Error);
}

namespace {

BoundarySpec drum_at(double x, double spin, bool is_free) {
  BoundarySpec spec;
  spec.name = "drum";
  spec.dimension = 2;
  spec.shape = BoundaryShape::cylinder;
  spec.side = CylinderSide::outside;
  spec.from = spec.motion.centre = {x, 0, 0};
  spec.radius = 0.3;
  if (!is_free) {
    spec.motion = moving({.spin = spin}, {x, 0});
    return spec;
  }
  spec.motion.initial = RigidVelocity{.spin = spin};
  spec.body = free_body(1, 40, {false, false, false, false, false, true});
  return spec;
}

BoundarySpec spinning_plank(double x, double spin) {
  BoundarySpec spec = plank("plank", {x - 0.1, 0}, {x + 0.1, 0}, 0.3);
  spec.motion = moving({.spin = spin}, {x, 0});
  return spec;
}

}  // namespace

TEST_CASE("a wall that turns drags grains across the end of its cell as it does elsewhere") {
  const auto dragged = [](const BoundarySpec& spec, double x, double period) {
    Dynamics dynamics = tight({spec});
    dynamics.interaction.friction = 0.5;
    dynamics.time.step = 0.002;
    Simulation simulation = in_cell({{.x = x, .y = 0.372, .radius = 0.1}}, dynamics, period);
    advance(simulation, 25);
    const GranularState& s = simulation.state;
    return std::array{s.velocity_x[0], s.velocity_y[0], s.spin[0],
                      s.body_velocities.empty() ? 0 : s.body_velocities[0].spin};
  };
  const auto check_same_drag = [&](const BoundarySpec& open, const BoundarySpec& across, double x, double image) {
    const auto expected = dragged(open, x, 0), met = dragged(across, image, 1.2);
    CHECK(std::abs(expected[2]) > 0.1);
    for (std::size_t k = 0; k < met.size(); ++k) CHECK(met[k] == doctest::Approx(expected[k]).epsilon(1e-9));
  };
  for (const bool is_free : {false, true}) {
    CAPTURE(is_free);
    check_same_drag(drum_at(1.1, 1, is_free), drum_at(1.1, 1, is_free), 1.25, 0.05);
    check_same_drag(drum_at(1.1, 1, is_free), drum_at(-0.1, 1, is_free), 1.25, 0.05);
  }
  check_same_drag(spinning_plank(1.1, 1), spinning_plank(1.1, 1), 1.25, 0.05);
}

TEST_CASE("a grain passes from one image of a wall to the next, and through none") {
  const auto end_of = [](double velocity, double y) {
    const Dynamics dynamics = without_gravity({drum_at(0.5, 0, false)}, 0.05);
    Simulation simulation = in_cell({{.x = 0.04, .y = y, .radius = 0.05, .velocity_x = velocity}}, dynamics, 1);
    advance(simulation, 2);
    return simulation.state.x[0];
  };
  CHECK(end_of(-1, 0) == doctest::Approx(1 - 0.06).epsilon(1e-12));  // 0.09 from the next image
  CHECK(end_of(-2, 0.5) == doctest::Approx(1 - 0.16).epsilon(1e-12));
  CHECK_THROWS_WITH_AS(end_of(-9, 0), doctest::Contains("dynamics.step"), Error);  // through the next image
  CHECK_THROWS_WITH_AS(end_of(9, 0), doctest::Contains("dynamics.step"), Error);
}

TEST_CASE("walls that do not fit their cell are refused") {
  const auto refused = [](BoundarySpec spec, double period, const char* part) {
    CHECK_THROWS_WITH_AS(in_cell({{.x = 0.1, .y = 3, .radius = 0.01}}, tight({spec}), period), doctest::Contains(part),
                         Error);
  };
  refused(drum_at(0.5, 0, false), 0.55, "boundary 'drum': expected a cylinder that is shorter");
  BoundarySpec plank = spinning_plank(0.5, 0);
  plank.radius = 0.01;
  plank.to = {0.6, 0.1, 0};  // 0.2 long along x, and askew
  in_cell({{.x = 0.1, .y = 3, .radius = 0.01}}, tight({plank}), 0.23);
  refused(plank, 0.21, "boundary 'plank': expected a plank that is shorter");
  plank.from = {0.5, -0.1, 0};
  plank.to = {0.5, 0.1, 0};  // across the cell
  plank.motion = {};
  in_cell({{.x = 0.1, .y = 3, .radius = 0.01}}, tight({plank}), 0.1);
  plank.motion = spinning_plank(0.5, 1).motion;
  refused(plank, 0.1, "0.22 m in a cell of 0.1 m");
  Packing packing{{0.1}, {0.1}, {0.01}, {1}, {3}};
  BoundarySpec rod = drum_at(0.5, 0, false);
  rod.dimension = 3;
  rod.to = {1.5, 0, 1};
  CHECK_THROWS_WITH_AS(scene(packing, tight({rod}), {.x = 1}), doctest::Contains("expected a cylinder"), Error);
  rod.to = {0.5, 0, 1};
  scene(packing, tight({rod}), {.x = 1});
}

TEST_CASE("a floor that is longer than its cell holds grains everywhere") {
  const BoundarySpec long_one = plank("plank", {-1.3, 0}, {2.7, 0}, 0.1);
  for (const double x : {0.01, 0.3, 0.7, 0.99}) {
    Simulation simulation = in_cell({{.x = x, .y = 0.2, .radius = 0.1}}, tight({long_one}), 1);
    advance(simulation, 10);
    CHECK(simulation.state.y[0] == doctest::Approx(0.2).epsilon(1e-12));
    CHECK(impulse_between(simulation.state, 0, 1).n == doctest::Approx(g * simulation.dynamics.time.step));
  }
}
