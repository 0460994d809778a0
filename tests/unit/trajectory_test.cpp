// SPDX-License-Identifier: GPL-3.0-or-later
// Trajectories: read back bit for bit, whole at every moment, gone on with exactly.
#include "formats/trajectory/trajectory.hpp"

#include "../support/granular.hpp"
#include "../support/moving_case.hpp"
#include "../support/run_program.hpp"
#include "../support/sanitized.hpp"
#include "files/csv.hpp"
#include "files/hdf5.hpp"
#include "formats/case/case_file.hpp"
#include "simulation/simulation.hpp"
#include <nscdd/formats/packing_file.hpp>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <hdf5.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <thread>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Whether HDF5 has the same error handler after `work` as before.
bool keeps_error_handler(const std::function<void()>& work) {
  const H5E_auto2_t mine = [](hid_t, void*) -> herr_t { return 0; };
  H5E_auto2_t before = nullptr, after = nullptr;
  void *data_before = nullptr, *data_after = nullptr;
  int data = 0;
  H5Eget_auto2(H5E_DEFAULT, &before, &data_before);
  H5Eset_auto2(H5E_DEFAULT, mine, &data);
  work();
  H5Eget_auto2(H5E_DEFAULT, &after, &data_after);
  H5Eset_auto2(H5E_DEFAULT, before, data_before);
  return after == mine && data_after == &data;
}

Simulation small(Index steps) {
  Simulation simulation = simulation_of({parse_case(moving_case(), "c.toml")});
  simulation.dynamics.time.steps = steps;
  return simulation;
}

TrajectoryHeader header_of(const Simulation& simulation) {
  return {"the case", "the build", {{"program", "test"}}, simulation.system};
}

// Runs to the end; the steps as they were given to the writer.
std::vector<TrajectoryStep> run_into(TrajectoryWriter& writer, Simulation& simulation, Index save_every = 1) {
  std::vector<TrajectoryStep> steps;
  RunSinks sinks;
  sinks.step = [&](const Simulation& after, const AnySolvedStep& any, const StepReport& report) {
    const auto& solved = std::get<GranularStep<2>>(any);
    steps.push_back(TrajectoryStep{after.state, trajectory_contacts(solved)});
    writer.append(steps.back(), {row(step_columns(), report)}, report.step % save_every == 0);
  };
  REQUIRE(run_simulation(simulation, sinks).end == RunEnd::completed);
  writer.commit();
  return steps;
}

struct RunFile {
  TemporaryFolder folder;
  std::string path = folder / "run.h5";
};

}  // namespace

TEST_CASE_FIXTURE(RunFile, "trajectory: what is written is read back, bit for bit") {
  Simulation simulation = small(6);
  std::vector<TrajectoryStep> steps;
  {
    TrajectoryWriter writer(path, header_of(simulation), {simulation.state, {}}, headings(step_columns()));
    steps = run_into(writer, simulation, 2);
    writer.end("completed");
  }
  CHECK(nscdd::testing::content_of(folder.path()).size() == 1);
  CHECK(trajectory_steps(path) == std::vector<Index>{0, 2, 4, 6});
  const TrajectoryHeader header = read_trajectory_header(path);
  CHECK(header.case_text == "the case");
  CHECK(header.build == "the build");
  CHECK(header.provenance == Provenance{{"program", "test"}});
  CHECK(header.system.radius == simulation.system.radius);
  CHECK(header.system.mass == simulation.system.mass);
  CHECK(header.system.driven_by == simulation.system.driven_by);
  REQUIRE(header.system.walls.size() == 1);
  CHECK(header.system.walls[0].normal == simulation.system.walls[0].normal);
  CHECK(header.system.boundaries[2].name == "right");
  CHECK(numbers_of(read_last_step(path).state) == numbers_of(simulation.state));
  const TrajectoryStep kept = read_trajectory_step(path, 4);
  CHECK(numbers_of(kept.state) == numbers_of(steps[3].state));
  REQUIRE(kept.contacts.size() == steps[3].contacts.size());
  REQUIRE(!kept.state.gluing.empty());
  for (std::size_t k = 0; k < kept.contacts.size(); ++k) {
    const TrajectoryContact &a = kept.contacts[k], &b = steps[3].contacts[k];
    CHECK(a.geometry.normal == b.geometry.normal);
    CHECK(a.geometry.point == b.geometry.point);
    CHECK(a.geometry.gap == b.geometry.gap);
    CHECK(a.status == b.status);
    CHECK(a.subdomain == b.subdomain);
  }
  CHECK(read_summary(path, "step") == std::vector<double>{1, 2, 3, 4, 5, 6});
  CHECK(read_summary(path, "time").back() == simulation.state.time);
  CHECK_THROWS_WITH_AS(read_trajectory_step(path, 5), doctest::Contains("met step 5"), Error);
  CHECK(!header.system.period.any());
  TrajectoryHeader periodic = header_of(simulation);
  periodic.system.period = {.x = 5, .y = 0};
  TrajectoryWriter(folder / "cell.h5", periodic, {simulation.state, {}}, headings(step_columns())).commit();
  CHECK(read_trajectory_header(folder / "cell.h5").system.period.x == 5);
}

TEST_CASE_FIXTURE(RunFile, "trajectory: 10 steps and 10 more are 20, bit for bit") {
  constexpr Index half = sanitized ? 3 : 10;
  Simulation whole = small(2 * half);
  REQUIRE(run_simulation(whole, {}).end == RunEnd::completed);
  {
    Simulation first = small(half);
    TrajectoryWriter writer(path, header_of(first), {first.state, {}}, headings(step_columns()));
    run_into(writer, first);
    writer.end("completed");
  }
  CHECK(read_end(path) == "completed");
  Simulation second = small(2 * half);
  second.state = read_last_step(path).state;
  CHECK(second.state.step == half);
  TrajectoryWriter writer(path, headings(step_columns()));
  writer.go_on("the longer case", "from step 10\n");
  CHECK(read_end(path) == "running");  // what a run that is killed from here on leaves
  run_into(writer, second);
  CHECK(read_trajectory_header(path).case_text == "the longer case");
  CHECK(numbers_of(second.state) == numbers_of(whole.state));
  CHECK(numbers_of(read_last_step(path).state) == numbers_of(whole.state));
  CHECK(count(trajectory_steps(path)) == 2 * half + 1);
  CHECK(count(read_summary(path, "step")) == 2 * half);
}

TEST_CASE("trajectory: a run that switches models goes on from any step, bit for bit") {
  const TemporaryFolder folder;
  Simulation simulation = small(sanitized ? 8 : 24);
  simulation.dynamics.solver.maximum_iterations = 400;
  simulation.dynamics.solver.model = SwitchedModel::linear;
  simulation.dynamics.solver.switch_after = 30;
  simulation.state.models.resize(2);
  const Simulation start = simulation;
  TrajectoryWriter writer(folder / "run.h5", header_of(simulation), {simulation.state, {}}, headings(step_columns()));
  const std::vector<TrajectoryStep> steps = run_into(writer, simulation);
  Index carried = 0;  // steps that begin with a linear subdomain
  for (std::size_t k = 0; k + 1 < steps.size(); k += sanitized ? 3 : 1) {
    Simulation rest = start;
    rest.state = read_trajectory_step(folder / "run.h5", steps[k].state.step).state;
    rest.dynamics.time.steps = rest.state.step + 1;
    carried += std::ranges::any_of(rest.state.models, [](const RememberedModel& one) { return one.standing >= 30; });
    REQUIRE(run_simulation(rest, {}).end == RunEnd::completed);
    CHECK(numbers_of(rest.state) == numbers_of(steps[k + 1].state));
  }
  CHECK((sanitized || carried > 5));
}

TEST_CASE("trajectory: steps reach the file together, in commits no more than a second apart") {
  const TemporaryFolder folder;
  const std::string one = folder / "one.h5", together = folder / "together.h5";
  Simulation simulation = small(4);
  TrajectoryWriter singly(one, header_of(simulation), {simulation.state, {}}, headings(step_columns()));
  TrajectoryWriter gathering(together, header_of(simulation), {simulation.state, {}}, headings(step_columns()));
  RunSinks sinks;
  sinks.step = [&](const Simulation& after, const AnySolvedStep& any, const StepReport& report) {
    const auto& solved = std::get<GranularStep<2>>(any);
    for (TrajectoryWriter* writer : {&singly, &gathering})
      writer->append(TrajectoryStep{after.state, trajectory_contacts(solved)}, {row(step_columns(), report)},
                     report.step == 2);
    singly.commit();
    CHECK(read_last_step(one).state.step == report.step);
    CHECK(read_last_step(together).state.step == 0);
    CHECK(trajectory_steps(together) == std::vector<Index>{0});
    CHECK(read_summary(together, "step").empty());
  };
  REQUIRE(run_simulation(simulation, sinks).end == RunEnd::completed);
  CHECK_FALSE(singly.due());
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  CHECK(gathering.due());
  gathering.commit();
  CHECK_FALSE(gathering.due());
  for (const std::string& path : {one, together}) {
    CHECK(trajectory_steps(path) == std::vector<Index>{0, 2});
    CHECK(read_summary(path, "step") == std::vector<double>{1, 2, 3, 4});
    CHECK(numbers_of(read_last_step(path).state) == numbers_of(simulation.state));
    CHECK(count(read_last_step(path).contacts) == count(read_last_step(one).contacts));
  }
  CHECK(read_summary(together, "time") == read_summary(one, "time"));
}

TEST_CASE_FIXTURE(RunFile, "trajectory: a writer that is given up commits what it has gathered") {
  Simulation simulation = small(1);
  {
    TrajectoryWriter writer(path, header_of(simulation), {simulation.state, {}}, headings(step_columns()));
    RunSinks sinks;
    sinks.step = [&](const Simulation& after, const AnySolvedStep& any, const StepReport& report) {
      const auto& solved = std::get<GranularStep<2>>(any);
      writer.append(TrajectoryStep{after.state, trajectory_contacts(solved)}, {row(step_columns(), report)}, true);
    };
    REQUIRE(run_simulation(simulation, sinks).end == RunEnd::completed);
  }
  CHECK(trajectory_steps(path) == std::vector<Index>{0, 1});
  CHECK(numbers_of(read_last_step(path).state) == numbers_of(simulation.state));
}

TEST_CASE_FIXTURE(RunFile, "trajectory: reading and writing leave HDF5's error handler as it was, failing or not") {
  const Simulation simulation = small(1);
  std::optional<TrajectoryWriter> writer;
  CHECK(keeps_error_handler([&] {
    writer.emplace(path, header_of(simulation), TrajectoryStep{simulation.state, {}}, headings(step_columns()));
  }));
  CHECK(keeps_error_handler([&] { writer->end("completed"); }));
  CHECK(keeps_error_handler([&] { read_last_step(path); }));
  for (const std::string& bytes : {std::string("no HDF5"), to_hdf5({}, std::vector<NamedTable>{})})
    CHECK(keeps_error_handler([&] { CHECK_THROWS_AS(packing_from_hdf5(bytes, "x"), Error); }));
}

TEST_CASE_FIXTURE(RunFile, "trajectory: a reader neither disturbs the writer nor is disturbed") {
  Simulation simulation = small(1);
  TrajectoryWriter writer(path, header_of(simulation), {simulation.state, {}}, headings(step_columns()));
  std::vector<int> open;
  for (Index steps = 1; steps <= 4; ++steps) {
    open.push_back(::open(path.c_str(), O_RDONLY));  // as the HDF5 library has it while it reads
    REQUIRE(::flock(open.back(), LOCK_SH) == 0);
    const std::string before = read_text("/proc/self/fd/" + std::to_string(open.back()));
    simulation.dynamics.time.steps = steps;
    run_into(writer, simulation);
    CHECK(read_text("/proc/self/fd/" + std::to_string(open.back())) == before);
    CHECK(numbers_of(read_last_step(path).state) == numbers_of(simulation.state));
  }
  for (const int descriptor : open) ::close(descriptor);
}

TEST_CASE_FIXTURE(RunFile, "trajectory: a second writer is refused") {
  const Simulation simulation = small(1);
  const TrajectoryWriter writer(path, header_of(simulation), {simulation.state, {}}, headings(step_columns()));
  CHECK_THROWS_WITH_AS(TrajectoryWriter(path, headings(step_columns())), doctest::Contains("by another run"), Error);
  const std::string link = folder / "link.h5";
  std::filesystem::create_symlink("run.h5", link);
  CHECK_THROWS_WITH_AS(TrajectoryWriter(link, headings(step_columns())), doctest::Contains("by another run"), Error);
}

TEST_CASE_FIXTURE(RunFile, "trajectory: what is none, or damaged, is refused") {
  const std::string other = folder / "other.h5";
  CHECK_THROWS_WITH_AS(read_last_step(other), doctest::Contains("met no such file"), Error);
  nscdd::testing::write_file(other, "x,y\n");
  CHECK_THROWS_WITH_AS(read_last_step(other), doctest::Contains("met something else"), Error);
  nscdd::testing::write_file(other, to_hdf5({}, std::vector<NamedTable>{}));
  CHECK_THROWS_WITH_AS(read_last_step(other), doctest::Contains("other.h5: last: expected a group, met none"), Error);
  const Simulation simulation = small(1);
  { TrajectoryWriter writer(path, header_of(simulation), {simulation.state, {}}, headings(step_columns())); }
  const std::string bytes = read_text(path);
  for (const std::size_t size : {bytes.size() / 10, bytes.size() / 2, bytes.size() - 1}) {
    nscdd::testing::write_file(other, bytes.substr(0, size));
    CHECK_THROWS_AS(read_last_step(other), Error);
  }
}

TEST_CASE_FIXTURE(RunFile, "trajectory: a state with arrays of different lengths is refused") {
  Simulation simulation = small(1);
  TrajectoryStep step{simulation.state, {}};
  step.state.spin.pop_back();
  { TrajectoryWriter writer(path, header_of(simulation), step, headings(step_columns())); }
  CHECK_THROWS_WITH_AS(check(simulation.system, read_last_step(path).state), doctest::Contains("disks"), Error);
}

TEST_CASE_FIXTURE(RunFile, "trajectory: numbers of steps, bodies and subdomains that are none are refused") {
  const Simulation simulation = small(1);
  const Index bodies = simulation.system.grains() + count(simulation.system.walls);
  const auto require_refused = [&](const std::function<void(TrajectoryStep&)>& damage, const std::string& part) {
    CAPTURE(part);
    TrajectoryStep step{simulation.state, {TrajectoryContact{}}};
    step.state.gluing.push_back({.grain = 0, .subdomain = 1});
    damage(step);
    { TrajectoryWriter writer(path, header_of(simulation), step, headings(step_columns())); }
    CHECK_THROWS_WITH_AS(read_last_step(path), doctest::Contains(part.c_str()), Error);
    CHECK_THROWS_WITH_AS(read_last_step(path), doctest::Contains("run.h5"), Error);
  };
  require_refused([](TrajectoryStep& s) { s.state.step = 2'000'000'000; }, "last/step: expected a number in 0..");
  require_refused([](TrajectoryStep& s) { s.state.step = -1; }, "last/step: expected a number in 0..");
  require_refused([](TrajectoryStep& s) { s.state.decomposed_at = -2; },
                  "last/decomposed_at: expected a number in -1..");
  require_refused([](TrajectoryStep& s) { s.contacts[0].geometry.a = -5; }, "contacts/a: expected");
  require_refused([&](TrajectoryStep& s) { s.contacts[0].geometry.b = bodies; }, "contacts/b: expected");
  require_refused([](TrajectoryStep& s) { s.contacts[0].subdomain = -5; }, "contacts/subdomain: expected");
  require_refused([&](TrajectoryStep& s) { s.state.gluing[0].grain = simulation.system.grains(); },
                  "interface/grain: expected");
  require_refused([](TrajectoryStep& s) { s.state.gluing[0].subdomain = 100'000'000; },
                  "interface/subdomain: expected");
}

TEST_CASE_FIXTURE(
    RunFile, "trajectory: a boundary that a grain or wall does not have is refused with the file and array it is in") {
  const auto require_refused = [&](const Simulation& simulation, const std::string& part) {
    const TrajectoryStep step{simulation.state, {}};
    { TrajectoryWriter writer(path, header_of(simulation), step, headings(step_columns())); }
    CHECK_THROWS_WITH_AS(read_trajectory_header(path), doctest::Contains(part.c_str()), Error);
  };
  Simulation simulation = small(1);
  simulation.system.driven_by[0] = 7;
  require_refused(simulation, "driven_by: expected a number in -1..");
  simulation.system.driven_by[0] = -1;
  simulation.system.walls.at(0).boundary = 7;
  require_refused(simulation, "boundary: expected a number in 0..");
}

TEST_CASE("trajectory: a state that is not finite is refused with the file it is in") {
  Simulation simulation = small(1);
  simulation.state.velocity_x[3] = infinity;
  CHECK_THROWS_WITH_AS(require_fit("run.h5", simulation), doctest::Contains("run.h5: disk 3: expected finite"), Error);
}
