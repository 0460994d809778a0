// SPDX-License-Identifier: GPL-3.0-or-later
// Bonds: contacts of a pair of colours that neither open nor slide, against closed forms.
#include "../support/granular.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Disks of radius 0.5 and mass 1, bonded to each other and to the wall through `from` and `to`.
Simulation bonded_disks(const std::vector<Grain>& disks, std::array<double, 2> from, std::array<double, 2> to,
                        const char* algorithm, Motion motion = {}) {
  Dynamics dynamics = tight({wall("glue", from, to, motion)});
  dynamics.time.step = 0.01;
  dynamics.interaction.law = std::string(Cohesive::name);
  dynamics.solver.algorithm = std::string(algorithm);
  dynamics.boundaries.front().colour = "glue";
  dynamics.colours = {{"disk", 0, -1}};
  dynamics.pairs = {{{"disk", "glue"}, {.bond = true}}, {{"disk", "disk"}, {.bond = true}}};
  return simulation_of(disks, dynamics);
}

}  // namespace

TEST_CASE("a disk bonded to a vertical wall rolls down it, like a gear on a rack") {
  for (const char* algorithm : {"nlgs", "auto"}) {
    CAPTURE(algorithm);
    Simulation simulation = bonded_disks({{.x = 0.5, .y = 0}}, {0, 1}, {0, 0}, algorithm);
    const double fall = 2 * g / 3;  // of a full disk whose rim is held
    for (Index k = 1; k <= 20; ++k) {
      advance(simulation);
      const double step = 0.01, velocity = -fall * step * static_cast<double>(k);
      CHECK(simulation.state.velocity_y[0] == doctest::Approx(velocity).epsilon(1e-10));
      CHECK(simulation.state.spin[0] == doctest::Approx(velocity / 0.5).epsilon(1e-10));
      CHECK(std::abs(simulation.state.x[0] - 0.5) < 1e-12);
    }
  }
}

TEST_CASE("a chain of bonded disks hangs from a ceiling: the first bond carries all of them") {
  constexpr Index links = 30;  // their weight is more than the first guess of what a bond must hold
  std::vector<Grain> chain;
  for (Index k = 0; k < links; ++k) chain.push_back({.x = 0, .y = -0.5 - static_cast<double>(k)});
  for (const char* algorithm : {"nlgs", "auto"}) {
    CAPTURE(algorithm);
    Simulation simulation = bonded_disks(chain, {1, 0}, {0, 0}, algorithm);
    std::vector<Index> rows;  // of a step that is solved again
    solved_report(simulation, {.row = [&](const IterationRow& row) { rows.push_back(row.record.iteration); }});
    CHECK(std::ranges::adjacent_find(rows, std::greater_equal()) == rows.end());
    advance(simulation, 3);
    for (Index k = 0; k < links; ++k) {
      const LocalVector<2> r =
          k == 0 ? impulse_between(simulation.state, 0, links) : impulse_between(simulation.state, k - 1, k);
      CHECK(r.n == doctest::Approx(-g * 0.01 * static_cast<double>(links - k)).epsilon(1e-8));
      CHECK(std::abs(simulation.state.velocity_y[at(k)]) < 1e-10);
    }
  }
}

TEST_CASE("a bond at a distance keeps it; bodies beyond the alert distance are not bonded") {
  const double gap = 0.02;  // the alert distance is 0.05 x 0.5
  Simulation near = bonded_disks({{.x = 0, .y = -0.5 - gap}}, {1, 0}, {0, 0}, "auto");
  advance(near, 10);
  CHECK(near.state.y[0] == doctest::Approx(-0.5 - gap).epsilon(1e-12));
  Simulation far = bonded_disks({{.x = 0, .y = -0.53}}, {1, 0}, {0, 0}, "auto");
  advance(far, 10);
  CHECK(far.state.velocity_y[0] == doctest::Approx(-0.1 * g).epsilon(1e-12));
}

TEST_CASE("bonded disks that go round each other keep their distance") {
  for (const double gap : {0.0, 0.02}) {
    CAPTURE(gap);
    const Grain left{.x = -0.5, .y = 50, .velocity_y = -1, .spin = 2},
        right{.x = 0.5 + gap, .y = 50, .velocity_y = 1, .spin = 2};
    Simulation simulation = bonded_disks({left, right}, {0, 0}, {1, 0}, "auto");
    simulation.dynamics.time.gravity = {0, 0};
    for (Index k = 0; k < 300; ++k) {
      advance(simulation);
      const double x = simulation.state.x[1] - simulation.state.x[0], y = simulation.state.y[1] - simulation.state.y[0];
      CHECK(std::abs(std::hypot(x, y) - (1 + gap)) < 4e-4);  // (h v)^2/d within a step
    }
    REQUIRE(simulation.state.bonds.size() == 1);
    CHECK(std::abs(simulation.state.bonds[0].gap - gap) < 1e-3);
  }
}

TEST_CASE("a disk at rest follows a wall that it is bonded to, and a rim that turns carries another") {
  Simulation pulled = bonded_disks({{.x = 0, .y = 0.5}}, {0, 0}, {1, 0}, "auto", moving({0.3, -1, 0}));
  pulled.dynamics.time.gravity = {0, 0};
  advance(pulled);
  CHECK(pulled.state.velocity_y[0] == doctest::Approx(-1).epsilon(1e-10));
  CHECK(pulled.state.velocity_x[0] + 0.5 * pulled.state.spin[0] == doctest::Approx(0.3).epsilon(1e-10));
  Simulation gears = bonded_disks({{.x = -0.5, .y = 9, .spin = 1}, {.x = 0.5, .y = 9}}, {0, 0}, {1, 0}, "auto");
  gears.dynamics.time.gravity = {0, 0};
  advance(gears);
  // u_t = 0.5 before, W_tt = 2 + 2 x 2 = 6 (1/kg): the impulse 1/12 N s.
  CHECK(std::abs(gears.state.velocity_y[1]) == doctest::Approx(1.0 / 12));
  CHECK(gears.state.velocity_y[0] == doctest::Approx(-gears.state.velocity_y[1]));
}

TEST_CASE("bonds that no impulse holds end the run") {
  Dynamics dynamics = bonded_disks({{.x = 0, .y = 0.5}}, {0, 0}, {1, 0}, "auto").dynamics;
  BoundarySpec other = wall("away", {1, 1}, {0, 1}, moving({0, 1, 0}));
  other.colour = "glue";
  dynamics.boundaries.push_back(other);
  dynamics.time.steps = 5;
  Simulation simulation = simulation_of({Grain{.x = 0, .y = 0.5}}, dynamics);
  CHECK(refusal_of(simulation).find("step 1: a bond parts") != std::string::npos);
  CHECK(simulation.state.step == 0);
}
