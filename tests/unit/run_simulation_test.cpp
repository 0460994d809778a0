// SPDX-License-Identifier: GPL-3.0-or-later
// How a run of steps ends.
#include "../support/granular.hpp"
#include "simulation/simulation.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace nscdd;

namespace {

// One disk at a height above a floor.
Simulation one_disk(double gap) {
  Dynamics dynamics;
  BoundarySpec floor;
  floor.name = "floor";
  dynamics.boundaries = {floor};
  dynamics.time.steps = 500;
  dynamics.time.rest_speed = 1e-6;
  GranularScene start = scene({{0.5}, {1 + gap}, {1}, {2}}, dynamics);
  return {std::move(start.system), std::move(start.state), dynamics, GridPartitioner{}};
}

}  // namespace

TEST_CASE("run: a disk that falls comes to rest, and not at its turning point") {
  Simulation simulation = one_disk(0.1);
  simulation.state.velocity_y[0] = 0.5;  // thrown up: slow for a moment at the top
  Index sunk = 0;
  RunSinks sinks;
  sinks.step = [&](const Simulation&, const AnySolvedStep& any, const StepReport& report) {
    const auto& solved = std::get<GranularStep<2>>(any);
    ++sunk;
    CHECK(count(solved.contacts) == report.contacts);
  };
  const RunOutcome outcome = run_simulation(simulation, sinks);
  CHECK(outcome.end == RunEnd::at_rest);
  CHECK(simulation.state.y[0] == doctest::Approx(1).epsilon(1e-6));
  CHECK(simulation.state.step < 500);
  CHECK(sunk == simulation.state.step);
}

TEST_CASE("run: steps that were quiet before count") {
  Simulation simulation = one_disk(0);
  CHECK(run_simulation(simulation, {}, {1, 0, 0, 0, 0, 0, 0, 0}).end == RunEnd::at_rest);
  CHECK(simulation.state.step == rest_steps - 7);
  CHECK(run_simulation(simulation, {}, std::vector<double>(at(rest_steps), 0.0)).end == RunEnd::at_rest);
  CHECK(simulation.state.step == rest_steps - 7);
}

TEST_CASE("run: a fast step among slow ones makes them count anew") {
  Simulation simulation = one_disk(0);
  CHECK(run_simulation(simulation, {}, {0, 0, 0, 0, 0, 0, 1, 0}).end == RunEnd::at_rest);
  CHECK(simulation.state.step == rest_steps - 1);
}

TEST_CASE("run: the slow beginning of a fall is no rest") {
  Simulation simulation = one_disk(0.1);
  simulation.dynamics.time.step = 1e-3;
  simulation.dynamics.time.rest_speed = 0.5;  // reached by falling for 51 steps, the disk lands after 142
  CHECK(run_simulation(simulation, {}).end == RunEnd::at_rest);
  CHECK(simulation.state.step > 142);
}

TEST_CASE("run: never at rest where no speed is given") {
  Simulation simulation = one_disk(0);
  simulation.dynamics.time.rest_speed = 0;
  simulation.dynamics.time.steps = 30;
  CHECK(run_simulation(simulation, {}).end == RunEnd::completed);
  CHECK(simulation.state.step == 30);
}

TEST_CASE("run: the monitor stops it between steps") {
  Simulation simulation = one_disk(1);
  RunSinks sinks;
  sinks.monitor = [](Index done, Index total) { return done < 3 && total == 500; };
  CHECK(run_simulation(simulation, sinks).end == RunEnd::stopped);
  CHECK(simulation.state.step == 3);
}

TEST_CASE("run: a step that cannot be prepared ends it, the last good state kept") {
  Simulation simulation = one_disk(1);
  RunSinks sinks;
  double y = 0;
  sinks.step = [&](const Simulation& after, const AnySolvedStep&, const StepReport&) { y = after.state.y[0]; };
  simulation.dynamics.time.gravity = {0, 2e5};  // ten radii per step after two
  const RunOutcome outcome = run_simulation(simulation, sinks);
  CHECK(outcome.end == RunEnd::broke_down);
  CHECK(outcome.reason.find("step 3: disk 0: expected to move by at most 10 of its radii") == 0);
  CHECK((simulation.state.step == 2 && simulation.state.y[0] == y));
}

TEST_CASE("run: bad input of the first step is an Error") {
  Simulation simulation = one_disk(1);
  simulation.state.velocity_x[0] = 1e9;
  CHECK_THROWS_AS(run_simulation(simulation, {}), Error);
}

TEST_CASE("run: mean speed is weighted by mass and takes free grains alone") {
  GranularSystem system;
  system.mass = {1, 3, 1000};
  system.radius = {1, 1, 1};
  system.driven_by = {-1, -1, 0};
  CHECK(mean_speed(system, 8) == 2);
}

TEST_CASE("status changes: contacts that close and contacts that open count") {
  Dynamics dynamics = testing::without_gravity();
  dynamics.interaction.law = "frictionless";
  // Disks 0 and 1 hit disk 2 from directions 70 degrees apart, at 1 and 10 m/s. The first sweep meets the slow
  // disk first and closes both contacts. Disk 2 then leaves disk 0 behind at 5 cos 70 m/s = 1.7 m/s, so that the
  // second sweep opens that contact, which is exact.
  const auto hitting = [](double degrees, double speed) {
    const double angle = degrees * std::numbers::pi / 180, x = std::cos(angle), y = std::sin(angle);
    const double distance = 1 + speed * 1e-3 / 2 - 1e-12;  // half a step before they touch
    return testing::Grain{.x = -distance * x, .y = -distance * y, .velocity_x = speed * x, .velocity_y = speed * y};
  };
  const Simulation simulation = testing::simulation_of({hitting(0, 1), hitting(70, 10), {}}, dynamics);
  std::vector<Index> changes;
  const GranularStep<2> step =
      solve_step(simulation, {.row = [&](const IterationRow& row) { changes.push_back(row.status_changes); }});
  REQUIRE(step.contacts.size() == 2);
  CHECK(step.contacts[0].impulse.n == 0);
  CHECK(step.contacts[1].impulse.n == doctest::Approx(5));
  CHECK(changes == std::vector<Index>{2, 1});
}

TEST_CASE("rows of steps and iterations have a value per column") {
  CHECK(row(step_columns(), {}).size() == headings(step_columns()).size());
  CHECK(row(iteration_columns(), {}).size() == headings(iteration_columns()).size());
}
