// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd simulate: what it prints and writes, going on, breakdowns, bad input, settled packings.
#include "../support/granular.hpp"
#include "files/csv.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"

#include <csignal>
#include <cstdlib>
#include <filesystem>

using namespace nscdd::testing;

namespace {

// Final states are the same to the last bit.
void check_same_end(const Session& session, const std::string& one, const std::string& two) {
  CHECK(numbers_of(nscdd::read_last_step(session.path(one)).state) ==
        numbers_of(nscdd::read_last_step(session.path(two)).state));
}

// All but the seconds of a table of iterations.
std::vector<std::vector<std::string>> rows_without_seconds(const std::string& csv) {
  CsvTable table = read_table(csv);
  REQUIRE(table.columns.back() == "seconds");
  for (auto& row : table.rows) row.pop_back();
  return table.rows;
}

// The cache of settled packings, in a folder of the test's own.
struct OwnCache {
  explicit OwnCache(const Session& session) { ::setenv("NSCDD_CACHE", session.path("cache").c_str(), 1); }
  ~OwnCache() { ::unsetenv("NSCDD_CACHE"); }
};

}  // namespace

TEST_CASE_FIXTURE(Session, "simulate: overlaps above a tenth of a radius are noticed, above a half they end the run") {
  file("one.csv", "x,y,radius\n0,0.5,0.5\n");
  file("press.toml", case_text("one.csv", "1, 1",
                               "[masses]\nmodel = \"unit\"\n[dynamics]\nsteps = 40\n[solver]\nmaximum_iterations = "
                               "20\nverdict = \"never\"\n") +
                         line_text("floor", "[0, 0]", "[1, 0]") +
                         line_text("lid", "[1, 1]", "[0, 1]", "centre = [0, 1]\nvelocity = [0, -0.5]\n"));
  const auto said = [&](const std::string& command) {  // standard error names the lack of room
    return ended(0, command, {"at first in step 1, contacts close although"}).standard_output;
  };
  CHECK_FALSE(contains(said("simulate press.toml --steps 5 -o little.h5"), "overlap by"));
  CHECK(contains(said("simulate press.toml --steps 60 -o some.h5"), "attention: bodies overlap by up to 0.1"));
  ended(1, "simulate press.toml --steps 400 -o crushed.h5",
        {"expected an overlap of at most 0.5 of the smaller radius", "disk 0 and the wall of boundary '"});
  const auto last = nscdd::read_last_step(path("crushed.h5"));
  CHECK(last.state.step > 40);
  CHECK(last.state.step < 400);
}

TEST_CASE_FIXTURE(MovingSession, "simulate: the rows of chosen iterations are those of all, and end with each step") {
  const std::string run = "simulate shear.toml --steps 3 --force -o run.h5 --convergence ";
  answer(run + "all.csv --convergence-every 1");
  answer(run + "few.csv");
  answer(run + "tens.csv --convergence-every 10");
  const CsvTable all = csv("all.csv");
  const auto places = [&](const CsvTable& table) {  // of its rows among all
    std::vector<std::size_t> found;
    for (std::size_t row = 0, k = 0; row < table.rows.size(); ++row, ++k) {
      while (k < all.rows.size() && (all.text(k, "step") != table.text(row, "step") ||
                                     all.text(k, "iteration") != table.text(row, "iteration")))
        ++k;
      REQUIRE(k < all.rows.size());
      for (const std::string& name : all.columns)
        if (name != "status_changes" && name != "seconds") CHECK(table.text(row, name) == all.text(k, name));
      found.push_back(k);
    }
    return found;
  };
  const auto few = places(csv("few.csv"));
  const auto tens = places(csv("tens.csv"));
  std::vector<std::size_t> expected_few, expected_tens;
  for (std::size_t k = 0; k < all.rows.size(); ++k) {
    const bool last = k + 1 == all.rows.size() || all.text(k + 1, "step") != all.text(k, "step");
    const auto iteration = static_cast<nscdd::Index>(all.number(k, "iteration"));
    const double tenths = 10 * std::log10(all.number(k, "iteration"));
    const double before = iteration == 1 ? -1 : 10 * std::log10(all.number(k, "iteration") - 1);
    if (last || std::floor(tenths) != std::floor(before)) expected_few.push_back(k);
    if (last || iteration % 10 == 0) expected_tens.push_back(k);
  }
  CHECK(few == expected_few);
  CHECK(tens == expected_tens);
  CHECK(few.size() < all.rows.size() / 2);
  answer("simulate shear.toml --steps 5 --restart -o run.h5 --convergence few.csv");
  check_refused("simulate shear.toml -o none.h5 --convergence-every 5",
                {"--convergence-every: expected --convergence with it, met none"});
}

TEST_CASE_FIXTURE(MovingSession, "simulate: says how the run went, one row per iteration") {
  const std::string text =
      answer("simulate shear.toml --steps 5 --convergence rows.csv --convergence-every 1 -o run.h5 --iterations 7");
  CHECK(contains(text, "completed: 5 steps in this run, 5 of 5 in all, t = 0.025 s"));
  CHECK(contains(text, "disks: 120 free, "));
  CHECK(contains(text, "maximum_reached"));
  CHECK(contains(text, "ns per contact and sweep"));
  const CsvTable rows = csv("rows.csv");
  CHECK(rows.columns == Texts{"step", "iteration", "sweeps", "zeta", "interface_change", "gluing", "normal_change",
                              "natural_map", "quad_dv", "quad_dvr", "mean_dv_over_r", "qm_16", "active", "stick",
                              "slide", "status_changes", "seconds"});
  CHECK(rows.text(rows.rows.size() - 1, "step") == "5");
  for (std::size_t k = 0; k < rows.rows.size(); ++k) CHECK(rows.number(k, "iteration") <= 7);
  CHECK(nscdd::read_summary(path("run.h5"), "iterations").size() == 5);
  CHECK(content_of(folder.path()).size() == 3);
}

TEST_CASE_FIXTURE(MovingSession, "simulate: options reach the solver, threads leave every bit") {
  answer("simulate shear.toml --steps 3 --threads 1 -o one.h5");
  answer("simulate shear.toml --steps 3 --threads 2 -o two.h5");
  check_same_end(*this, "one.h5", "two.h5");
  for (const std::string& options : Texts{"--algorithm nlgs", "--algorithm enriched --eta 1", "--gauss-seidel-sweeps 5",
                                          "--subdomains 2x2", "--criterion interface_change --tolerance 0.1",
                                          "--tolerance 0.1", "--iterations 5", "--set interaction.friction=0"}) {
    CAPTURE(options);
    answer("simulate shear.toml --steps 3 --force -o other.h5 " + options);
    CHECK(nscdd::read_last_step(path("other.h5")).state.x != nscdd::read_last_step(path("one.h5")).state.x);
  }
}

TEST_CASE_FIXTURE(MovingSession, "simulate: 50 steps and a restart to 100 are 100, bit for bit, rows included") {
  REQUIRE(contains(read("shear.toml"), "warm_start = true"));
  answer("simulate shear.toml --convergence whole.csv -o whole.h5 --steps 100");
  answer("simulate shear.toml --convergence parts.csv -o parts.h5 --steps 50");
  answer("simulate shear.toml --convergence parts.csv -o parts.h5 --steps 100 --restart");
  check_same_end(*this, "whole.h5", "parts.h5");
  CHECK(rows_without_seconds(read("parts.csv")) == rows_without_seconds(read("whole.csv")));
  CHECK(nscdd::trajectory_steps(path("parts.h5")).size() == 101);
  const std::string again = answer("simulate shear.toml -o parts.h5 --steps 100 --restart");
  CHECK(contains(again, "0 steps in this run, 100 of 100 in all"));
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a restart between two decompositions keeps the one before, and eta") {
  for (const std::string& options :
       Texts{"--set solver.redecompose=4", "--algorithm schwarz --set solver.redecompose=4",
             "--algorithm enriched --eta optimal",
             "--algorithm enriched --eta optimal --gauss-seidel-sweeps 20 --set "
             "solver.redecompose=4"}) {
    CAPTURE(options);
    const std::string line = "simulate shear.toml --iterations 30 --force " + options;
    answer(line + " -o whole.h5 --steps 11");
    answer(line + " -o parts.h5 --steps 6");  // 6: two steps behind a decomposition
    const std::string restart = "simulate shear.toml --iterations 30 --restart " + options;
    answer(restart + " -o parts.h5 --steps 11");
    check_same_end(*this, "whole.h5", "parts.h5");
    CHECK(nscdd::read_last_step(path("whole.h5")).state.eta == nscdd::read_last_step(path("parts.h5")).state.eta);
  }
}

TEST_CASE_FIXTURE(MovingSession, "simulate: the last state is kept whatever is saved") {
  answer("simulate shear.toml -o whole.h5");
  answer("simulate shear.toml -o thin.h5 --steps 13 --save-every 5");
  CHECK(nscdd::trajectory_steps(path("thin.h5")) == std::vector<nscdd::Index>{0, 5, 10, 13});
  answer("simulate shear.toml -o thin.h5 --restart --save-every 100");
  check_same_end(*this, "whole.h5", "thin.h5");
}

TEST_CASE_FIXTURE(MovingSession, "simulate: killed at any moment it can be read and goes on") {
  const std::string line = "simulate shear.toml --steps 400 --save-every 20 -o ";
  answer(line + "whole.h5");
  std::string restart;
  int kills = 0;
  for (int round = 0; round < 30; ++round) {
    CAPTURE(round);
    // The first run writes its file whole before it is killed, the others are killed a little later each.
    const std::size_t bytes = round == 0 ? 250'000 : 9'001 * static_cast<std::size_t>(round);
    const Outcome outcome = run(line + "run.h5" + restart, {.signal_at = SignalAt{"run.h5*", bytes}});
    REQUIRE((outcome.exit_code == 128 + SIGKILL || outcome.exit_code == 0));
    kills += outcome.exit_code != 0;
    const auto last = nscdd::read_last_step(path("run.h5"));
    CHECK(nscdd::read_summary(path("run.h5"), "step").size() == static_cast<std::size_t>(last.state.step));
    restart = " --restart";
  }
  CHECK(kills > 20);
  answer(line + "run.h5 --restart");
  check_same_end(*this, "whole.h5", "run.h5");
  CHECK(nscdd::trajectory_steps(path("run.h5")).size() == 21);
  CHECK(content_of(folder.path()).size() == 3);
}

TEST_CASE_FIXTURE(MovingSession, "simulate: Ctrl-C keeps the steps done and says how to go on") {
  const std::string line = "simulate shear.toml --steps 2000 --save-every 1000 --convergence rows.csv -o run.h5";
  const Outcome outcome = ended(130, line, {}, {.signal_at = SignalAt{"rows.csv.partial", 1, SIGINT}});
  CHECK(outcome.standard_output == "");
  const auto steps = std::to_string(nscdd::read_last_step(path("run.h5")).state.step);
  CHECK(contains(outcome.standard_error,
                 "run.h5: interrupted after " + steps + " of 2000 steps; --restart goes on with it"));
  CHECK(has("rows.csv.partial"));
}

TEST_CASE_FIXTURE(Session, "simulate: a breakdown names the disk, keeps the last good state and exits with 1") {
  file("worse.toml", replaced(moving_case(), "spin = -0.075", "motion = [[0.05, 0, 0, 0], [0.051, 1e6, 0, 0]]"));
  const Outcome outcome = ended(1, "simulate worse.toml -o run.h5",
                                {"run.h5: broke down in step 11: disk ", "it holds the last good state"});
  CHECK(contains(outcome.standard_output, "broke down: 10 steps in this run"));
  CHECK(nscdd::read_last_step(path("run.h5")).state.step == 10);
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a step that explodes, or has no numbers, is not the last good state") {
  ended(1, "simulate shear.toml --algorithm enriched --eta 1e-4 --iterations 8 -o run.h5",
        {": more energy than loads, boundaries and pushes can bring after ", "contact of disk "});
  const auto end = nscdd::read_last_step(path("run.h5")).state;
  for (const double speed : end.velocity_y) CHECK(std::abs(speed) < 10);
  file("light.csv", "x,y,radius,mass\n0,0,1,1\n2,0,1,1e-310\n4,0,1,1\n");
  file("light.toml", case_text("light.csv", "1, 1", "[dynamics]\nsteps = 3\n"));
  check_refused("simulate light.toml -o light.h5", {"light.toml: disk 1: expected a mass whose inverse is finite"});
  ended(1, "simulate light.toml -o light.h5 --algorithm nlgs", {"not finite"});
  CHECK(nscdd::read_last_step(path("light.h5")).state.step == 0);
}

TEST_CASE_FIXTURE(MovingSession, "simulate: says what a reader of its numbers must know") {
  CHECK(contains(answer("simulate shear.toml --steps 3 --iterations 7 -o few.h5"),
                 "attention: 3 of 3 steps ended before zeta fell to 0.0001 and jumps to 0.01; "));
  CHECK(contains(answer("simulate shear.toml --steps 3 --iterations 7 -o nlgs.h5 --algorithm nlgs"),
                 "attention: 3 of 3 steps ended before zeta fell to 0.0001; --iterations"));
  CHECK_FALSE(contains(answer("simulate shear.toml --steps 3 --iterations 100000 -o all.h5"), "attention"));
  file("inside.csv", "x,y,radius\n0,0,1\n1.9,0,1\n");
  file("inside.toml", case_text("inside.csv", "1, 1",
                                "[masses]\nmodel = \"unit\"\n[dynamics]\nsteps = 2\nstep = 1e-4\ngravity = [0, 0]\n"));
  CHECK_FALSE(contains(answer("simulate inside.toml -o inside.h5"), "attention: contacts added "));
  const std::string pushed = " --force --set dynamics.maximum_push_speed=1e9";
  CHECK(contains(answer("simulate inside.toml -o inside.h5" + pushed),
                 " J in 1 steps: overlaps pushed apart (dynamics.maximum_push_speed)\n"));
}

TEST_CASE_FIXTURE(MovingSession, "simulate: bad input is refused and nothing is written") {
  check_refused("simulate disks4 -o run.h5", {"disks4", "[dynamics]"});
  check_refused("simulate shear.toml -o run.csv", {"run.csv", ".h5"});
  check_refused("simulate shear.toml -o nowhere/run.h5", {"nowhere"});
  check_refused("simulate shear.toml -o run.h5 --algorithm jacobi", {"--algorithm", "jacobi"});
  check_refused("simulate shear.toml -o run.h5 --algorithm enriched --eta best", {"--eta", "best"});
  check_refused("simulate shear.toml -o run.h5 --eta 2", {"--eta", "enriched", "met generic"});
  check_refused("simulate shear.toml -o run.h5 --algorithm nlgs --subdomains 2x2", {"--subdomains", "nlgs"});
  check_refused("simulate shear.toml -o run.h5 --tolerance -1", {"--tolerance", "-1"});
  check_refused("simulate shear.toml -o run.h5 --save-every 0", {"--save-every"});
  check_refused("simulate shear.toml -o run.h5 --subdomains 2", {"--subdomains", "2x1"});
  check_refused("simulate shear.toml -o run.h5 --set solver.speed=1", {"solver.speed", "solver.order"});
  check_refused("simulate shear.toml -o run.h5 --restart", {"run.h5", "no such file"});
  answer("simulate shear.toml --steps 2 -o two.h5");
  check_refused("simulate shear.toml --steps 1 -o two.h5 --restart", {"two.h5", "2 steps or more", "met 1"});
  file("wide.toml", replaced(moving_case(), "radius = 0.198\n[[", "radius = 1e-9\n[["));
  check_refused("simulate wide.toml -o run.h5", {"floor", "disks"});
  answer("simulate shear.toml --steps 1 -o run.h5");
  check_refused("simulate shear.toml -o run.h5", {"run.h5", "exists already", "--force"});
  check_refused("simulate shear.toml -o run.h5 --restart --force", {"--restart"});
  check_refused("simulate shear.toml -o run.h5 --restart --set interaction.friction=0.2",
                {"run.h5", "friction = 0.3", "friction = 0.2"});
  check_refused("simulate shear.toml -o run.h5 --restart --algorithm nlgs", {"run.h5", "nlgs"});
  check_refused("simulate shear.toml -o run.h5 --force --convergence run.h5", {"run.h5", "twice"});
  file("text.h5", "not HDF5");
  check_refused("simulate shear.toml -o text.h5 --restart", {"text.h5", "trajectory"});
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a full disk is an error, and a restart goes on with the steps before it") {
  answer("simulate shear.toml --steps 2 -o run.h5");
  ended(2, "simulate shear.toml --steps 400 --restart -o run.h5", {"nscdd: error: "}, {.largest_file = 600'000});
  const auto step = nscdd::read_last_step(path("run.h5")).state.step;
  CHECK(step >= 2);
  CHECK(step < 400);
  CHECK(!has("run.h5.next"));
  answer("simulate shear.toml --steps 60 --restart -o run.h5");
  CHECK(nscdd::read_last_step(path("run.h5")).state.step == 60);
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a settled packing is made once, and again where the cache is damaged") {
  const OwnCache cache(*this);
  file("test.toml", replaced(moving_case(), "generator = \"deposit\"\ngrains = 120\nwidth = 3.0\nradius_max = 0.198\n",
                             "settled = \"shear.toml\"\n"));
  answer("simulate test.toml --steps 2 -o first.h5");
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder / "cache")) entries.push_back(entry.path());
  REQUIRE(entries.size() == 1);
  const std::string good = read_file(entries[0]);
  // its grains are those the other case ends with
  answer("simulate shear.toml -o settling.h5");
  const auto settled = nscdd::read_last_step(path("settling.h5")).state;
  const auto begun = nscdd::read_trajectory_step(path("first.h5"), 0).state;
  for (std::size_t i = 0; i < 120; ++i) {
    CHECK(begun.x[i] == settled.x[i]);
    CHECK(begun.y[i] == settled.y[i]);
  }
  std::string damaged = good;
  damaged[damaged.size() - 5] = damaged[damaged.size() - 5] == '1' ? '2' : '1';
  for (const std::string& content : Texts{damaged, "", good.substr(0, good.size() / 2)}) {
    write_file(entries[0], content);
    answer("simulate test.toml --steps 2 --force -o second.h5");
    CHECK(read_file(entries[0]) == good);
    check_same_end(*this, "first.h5", "second.h5");
  }
  answer("inspect test.toml --set contacts.overlap_tolerance=1");
}

TEST_CASE_FIXTURE(Session, "simulate: a case that is settled from itself is refused") {
  const OwnCache cache(*this);
  const auto settled = [&](const std::string& from) {
    return replaced(moving_case(), "generator = \"deposit\"\ngrains = 120\nwidth = 3.0\nradius_max = 0.198\n",
                    "settled = \"" + from + "\"\n");
  };
  file("a.toml", settled("b.toml"));
  file("b.toml", settled("c.toml"));
  file("c.toml", settled("a.toml"));
  file("d.toml", settled("none.toml"));
  file("e.toml", settled("still.toml"));
  file("still.toml", case_text("strip"));
  check_refused("simulate a.toml -o run.h5",
                {"a.toml:3: packing.settled", "settled from itself", "a.toml -> b.toml -> c.toml -> a.toml"});
  check_refused("simulate d.toml -o run.h5", {"d.toml:3", "none.toml", "no such file"});
  check_refused("simulate e.toml -o run.h5", {"e.toml:3", "still.toml", "[dynamics]"});
}

TEST_CASE_FIXTURE(MovingSession, "simulate: --force does not replace what a run is made from") {
  const std::string text = nscdd::read_text(path("shear.toml"));
  check_refused("simulate shear.toml --steps 1 -o run.h5 --convergence shear.toml --force",
                {"shear.toml", "which would be lost"});
  CHECK(nscdd::read_text(path("shear.toml")) == text);
  CHECK_FALSE(fs::exists(folder / "run.h5"));
}

TEST_CASE_FIXTURE(Session, "simulate: prescribed grains start with their velocity, grains in each other are refused") {
  const std::string rest =
      "\n[masses]\nmodel = \"unit\"\n[partition]\ngrid = [1, 1]\n[dynamics]\nsteps = 1\nstep = 0.01\ngravity "
      "= [0, 0]\n"
      "[[prescribed]]\ngrain = 1\nvelocity = [0.5, -0.25]\n";
  file("apart.csv", "x,y,radius\n0,0,1\n5,0,1\n");
  file("apart.toml", "[packing]\nfile = \"apart.csv\"" + rest);
  answer("simulate apart.toml -o apart.h5");
  const auto end = nscdd::read_last_step(path("apart.h5")).state;
  CHECK(end.velocity_x == std::vector<double>{0, 0.5});
  CHECK(end.x[1] == doctest::Approx(5.005).epsilon(1e-14));
  CHECK(end.y[1] == doctest::Approx(-0.0025).epsilon(1e-14));
  file("inside.csv", "x,y,radius\n0,0,1\n1.2,0,1\n");
  file("inside.toml", "[packing]\nfile = \"inside.csv\"" + rest);
  check_refused("simulate inside.toml -o inside.h5", {"disk 0 and disk 1: expected an overlap of at most 0.5"});
}

TEST_CASE_FIXTURE(MovingSession, "simulate: an impossible first step is refused before --force replaces a run") {
  answer("simulate shear.toml --steps 2 -o keep.h5");
  const std::string before = nscdd::read_text(path("keep.h5"));
  file("fast.toml", moving_case() + "\n[[prescribed]]\ngrain = 0\nvelocity = [1e6, 0.0]\n");
  check_refused("simulate fast.toml -o keep.h5 --force", {"disk 0", "radii in a step"});
  check_refused("simulate shear.toml --subdomains 100000x100000 -o keep.h5 --force", {"100000"});
  CHECK(nscdd::read_text(path("keep.h5")) == before);
  check_refused("simulate fast.toml -o fast.h5", {"disk 0"});
  CHECK_FALSE(fs::exists(folder / "fast.h5"));
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a restart does not cut the finished table of another run") {
  answer("simulate shear.toml --steps 3 -o long.h5 --convergence long.csv");
  answer("simulate shear.toml --steps 1 -o short.h5");
  const std::string before = nscdd::read_text(path("long.csv"));
  check_refused("simulate shear.toml --steps 2 -o short.h5 --restart --convergence long.csv",
                {"long.csv", "a run of 1 steps", "later steps"});
  CHECK(nscdd::read_text(path("long.csv")) == before);
}

TEST_CASE_FIXTURE(MovingSession, "simulate: says that a semi-implicit step leaves jumps") {
  const std::string text = answer(
      "simulate shear.toml --steps 3 -o once.h5 --iterations 100000 --algorithm enriched --eta 1 --set "
      "solver.enrichment=semi_implicit");
  CHECK(contains(text, "3 converged"));
  CHECK(contains(text, "attention: grains were left with jumps of "));
}

namespace {

// A disk, or two that meet head on, with a case that begins with `packing`.
std::string case_of(const std::string& packing, const std::string& rest) {
  return case_text(packing, "1, 1", "[masses]\nmodel = \"given\"\n[interaction]\nfriction = 0.3\n" + rest);
}

}  // namespace

TEST_CASE_FIXTURE(Session, "simulate: grains that go on together leave no residual") {
  file("two.csv", "x,y,radius,mass\n0,0.5,0.5,1\n1.001,0.5,0.5,1\n");
  file("two.toml", case_of("two.csv",
                           "[dynamics]\nstep = 0.005\nsteps = 6\n"
                           "[[prescribed]]\ngrain = 0\nvelocity = [1.0, 0.0]\n"));
  for (const std::string algorithm : {"auto", "newton", "nlgs", "accelerated"}) {
    CAPTURE(algorithm);
    const std::string text = answer("simulate two.toml -o " + algorithm + ".h5 --algorithm " + algorithm +
                                    " --convergence " + algorithm + ".csv --convergence-every 1");
    CHECK(contains(text, "steps: 6 converged"));
    CHECK_FALSE(contains(text, "attention"));
    for (const double map : nscdd::read_summary(path(algorithm + ".h5"), "natural_map")) CHECK(map <= 1e-8);
    const CsvTable rows = read_table(read(algorithm + ".csv"));
    for (std::size_t k = 0; k < rows.rows.size(); ++k) CHECK(rows.number(k, "natural_map") <= 1.0001);
    CHECK(rows.number(rows.rows.size() - 1, "natural_map") <= 1e-8);
  }
}

TEST_CASE_FIXTURE(Session, "simulate: walls without room are named in summary, file, page and standard error") {
  file("one.csv", "x,y,radius,mass\n0,0.5,0.5,1\n");
  file("closing.toml", case_of("one.csv", "[dynamics]\nstep = 0.005\nsteps = 20\ngravity = [0, -9.81]\n" +
                                              line_text("left", "[-0.5, 5]", "[-0.5, -5]") +
                                              line_text("right", "[0.5, -5]", "[0.5, 5]", "velocity = [-0.1, 0]\n")));
  const std::string said = "in 20 of 20 steps, at first in step 1, contacts close although";
  const Outcome closing = ended(0, "simulate closing.toml -o closing.h5 --verdict never", {"closing.h5: " + said});
  CHECK(contains(closing.standard_output, "attention: " + said));
  CHECK(contains(closing.standard_output, "check first that the boundaries leave room"));
  CHECK_FALSE(contains(closing.standard_output, "--iterations allows more"));
  const std::string file = path("closing.h5");
  for (const double flag : nscdd::read_summary(file, "no_room")) CHECK(flag == 1);
  for (const double map : nscdd::read_summary(file, "natural_map")) CHECK(map > 1e-8);
  // E = max(|r^1|, p): the wall closes at 0.1 m/s on a disk of 1 kg.
  for (const double driving : nscdd::read_summary(file, "driving")) CHECK(driving >= 0.1);
  for (const double residual : nscdd::read_summary(file, "driven_residual")) CHECK(residual > 0.1);
  answer("report closing.h5 -o closing.html");
  CHECK(contains(read("closing.html"), "no_room"));
  const Outcome few =
      run("simulate closing.toml -o few.h5 --verdict never --algorithm nlgs --iterations 300 --steps 3");
  CHECK(contains(few.standard_error, "in 3 of 3 steps, at first in step 1"));
  CHECK_FALSE(contains(few.standard_output, "--iterations allows more"));
}

TEST_CASE_FIXTURE(Session, "simulate: contacts of a packing at rest add no energy beyond what the tolerance leaves") {
  std::string pile = "x,y,radius,mass\n";  // a triangle of 21 grains between two walls, every contact closed
  int row = 0;
  for (const std::string height : {"0.5", "1.3660254037844386", "2.2320508075688772", "3.0980762113533158",
                                   "3.9641016151377544", "4.830127018922193"}) {
    for (int k = 0; k < 6 - row; ++k) pile += std::to_string(k + 0.5 * row + 0.5) + "," + height + ",0.5,1\n";
    ++row;
  }
  file("pile.csv", pile);
  file("pile.toml",
       case_of("pile.csv", "[dynamics]\nstep = 0.005\nsteps = 20\n" + line_text("floor", "[0, 0]", "[1, 0]") +
                               line_text("left", "[0, 5]", "[0, -5]") + line_text("right", "[6, -5]", "[6, 5]")));
  for (const std::string tolerance : {"1e-6", "1e-8", "1e-10"}) {
    CAPTURE(tolerance);
    const std::string text = answer("simulate pile.toml --force -o pile.h5 --tolerance " + tolerance);
    CHECK(contains(text, "steps: 20 converged"));
    CHECK_FALSE(contains(text, "contacts added"));
  }
}
