// SPDX-License-Identifier: GPL-3.0-or-later
// A boundary releases its grains one by one: they fall freely from its point, and those that wait touch nothing.
#include "../support/granular.hpp"
#include "../support/run_program.hpp"
#include "formats/trajectory/trajectory.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr double rain_step = 0.01, release_height = 4, release_distance = 1.2;

// Three disks of radius 0.5 that wait within each other and within a fourth one, which rests on the floor.
Simulation rain(const Grain& fourth = {.x = 3, .y = 0.5}) {
  Dynamics dynamics = tight({floor_wall()});
  dynamics.time.step = rain_step;
  dynamics.time.steps = 250;
  BoundarySpec source = driven_grains("source", 0, 2);
  source.source = GrainSource{{0, release_height, 0}, release_distance};
  dynamics.boundaries.push_back(source);
  return simulation_of({{.x = 3, .y = 0.4}, {.x = 3, .y = 0.4, .mass = 2}, {.x = 3.1, .y = 0.1}, fourth}, dynamics);
}

// The first step at whose end a disk that falls from rest is farther than release_distance below: its places are
// z_k = g h^2 k^2 / 2, since theta = 1/2.
Index steps_to_clear() {
  Index k = 0;
  while (g * rain_step * rain_step * static_cast<double>(k * k) / 2 <= release_distance) ++k;
  return k;
}

}  // namespace

TEST_CASE("a source releases a grain at rest as soon as the last one has gone its distance, and waits for the next") {
  Simulation simulation = rain();
  const Index wait = steps_to_clear();
  REQUIRE(simulation.state.released.size() == 1);
  CHECK(simulation.state.y[0] == release_height);
  CHECK(simulation.system.free(0));
  CHECK(!simulation.system.free(1));
  for (Index k = 1; k <= wait; ++k) {
    const StepReport report = advance(simulation);
    CHECK(simulation.state.y[0] ==
          doctest::Approx(release_height - g * rain_step * rain_step * static_cast<double>(k * k) / 2).epsilon(1e-12));
    CHECK(simulation.state.impulses.size() == 1);  // the disk on the floor: none of those that wait
    CHECK(std::abs(report.energy.numerical) < 1e-12);
    CHECK(simulation.state.released.size() == (k < wait ? 1 : 2));
  }
  CHECK(simulation.state.x[1] == 0);
  CHECK(simulation.state.y[1] == release_height);
  CHECK(simulation.state.velocity_y[1] == 0);
  // The third comes when the second has gone; the others come to rest on the first.
  advance(simulation, wait - 1);
  CHECK(simulation.state.released.size() == 2);
  advance(simulation);
  CHECK(simulation.state.released.size() == 3);
  advance(simulation, 150);
  double on_floor = 0;
  for (const RememberedImpulse& one : simulation.state.impulses) on_floor += one.b == 4 ? one.impulse[0] : 0;
  CHECK(on_floor == doctest::Approx(5 * g * rain_step).epsilon(1e-6));
}

TEST_CASE("a source waits while another grain is near its point, whichever it is") {
  Simulation simulation = rain();
  advance(simulation, steps_to_clear() - 1);
  simulation.state.x[3] = 0.5;
  simulation.state.y[3] = release_height + 0.8;
  advance(simulation, 2);
  CHECK(simulation.state.released.size() == 1);
  CHECK(rain({.x = 1.1, .y = release_height}).state.released.size() == 1);  // near, but not touched
  Simulation occupied = rain({.x = 0.5, .y = release_height + 0.8});
  CHECK(occupied.state.released.empty());
  advance(occupied, 70);
  CHECK(occupied.state.released.size() == 1);
}

TEST_CASE("a run with a source that goes on from its trajectory has the bits of one run") {
  const TemporaryFolder folder;
  const std::string path = folder / "rain.h5";
  CaseSpec spec;
  spec.packing = PackingFile{"rain.csv"};
  spec.dynamics = rain().dynamics;
  Simulation whole = rain(), first = rain();
  REQUIRE(refusal_of(whole).empty());
  first.dynamics.time.steps = steps_to_clear() + 5;
  {
    const TrajectoryHeader header{to_toml(spec), "the build", {}, first.system};
    TrajectoryWriter writer(path, header, {first.state, {}}, headings(step_columns()));
    RunSinks sinks;
    sinks.step = [&](const Simulation& after, const AnySolvedStep& solved, const StepReport& report) {
      writer.append({after.state, trajectory_contacts(std::get<GranularStep<2>>(solved))},
                    {row(step_columns(), report)}, true);
    };
    REQUIRE(run_simulation(first, sinks).end == RunEnd::completed);
    writer.end("completed");
  }
  Simulation second = rebuilt_simulation(path, read_trajectory_header(path), read_last_step(path).state);
  CHECK(second.state.released.size() == 2);
  REQUIRE(refusal_of(second).empty());
  CHECK(second.state.y == whole.state.y);
  CHECK(second.state.velocity_y == whole.state.velocity_y);
}
