// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd simulate: links to a trajectory, names beside it, the table that a restart goes on with.
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"
#include <nscdd/core/table.hpp>

#include <filesystem>

using namespace nscdd::testing;

namespace {

struct MovingSession : Session {
  MovingSession() { file("shear.toml", moving_case()); }
  nscdd::Index last_step(const std::string& name) const { return nscdd::read_last_step(path(name)).state.step; }
};

}  // namespace

TEST_CASE_FIXTURE(MovingSession, "simulate: through a symbolic link its target is written, and stays linked") {
  fs::create_directory(folder / "store");
  answer("simulate shear.toml --steps 2 -o store/real.h5");
  fs::create_symlink("store/real.h5", folder / "first.h5");
  fs::create_symlink("first.h5", folder / "link.h5");
  answer("simulate shear.toml --steps 4 --restart -o link.h5");
  CHECK(fs::is_symlink(folder / "link.h5"));
  CHECK(last_step("store/real.h5") == 4);
  answer("simulate shear.toml --steps 4 -o plain.h5");
  CHECK(nscdd::read_last_step(path("store/real.h5")).state.x == nscdd::read_last_step(path("plain.h5")).state.x);
  file("store/real.h5.next", "mine");
  check_refused("simulate shear.toml --steps 5 --restart -o link.h5", {"store/real.h5.next", "move it away"});
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a second name of a trajectory keeps the version it has") {
  answer("simulate shear.toml --steps 2 -o run.h5");
  fs::create_hard_link(folder / "run.h5", folder / "kept.h5");
  const std::string before = read("kept.h5");
  answer("simulate shear.toml --steps 5 --restart -o run.h5");
  CHECK(read("kept.h5") == before);
  CHECK(last_step("run.h5") == 5);
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a trajectory of another build of the program is not gone on with") {
  answer("simulate shear.toml --steps 2 -o run.h5");
  const std::string build = nscdd::build_fingerprint(), other(build.size(), 'x');
  file("run.h5", replaced(read("run.h5"), build, other));
  check_refused("simulate shear.toml --steps 4 --restart -o run.h5", {"run.h5", "build", build, other});
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a restart that is refused for its table leaves the trajectory as it was") {
  answer("simulate shear.toml --steps 2 -o run.h5");
  file("foreign.csv.partial", "a,b\n1,2\n");
  check_refused("simulate shear.toml --steps 4 --restart -o run.h5 --convergence foreign.csv",
                {"foreign.csv.partial", "met other columns"});
  file("both.csv", "mine");
  file("both.csv.partial", "");
  check_refused("simulate shear.toml --steps 4 --restart -o run.h5 --convergence both.csv",
                {"both.csv", "exists already"});
}

TEST_CASE_FIXTURE(Session, "simulate: a restart drops the rows of the step that broke down") {
  file("worse.toml", replaced(moving_case(), "spin = -0.075", "motion = [[0.05, 0, 0, 0], [0.051, 1e6, 0, 0]]"));
  const auto row_count = [&] { return csv("rows.csv").rows.size(); };
  CHECK(run("simulate worse.toml -o run.h5 --convergence rows.csv").exit_code == 1);
  const auto first = row_count();
  CHECK(run("simulate worse.toml --restart -o run.h5 --convergence rows.csv").exit_code == 1);
  CHECK(row_count() == first);
  // where iterations of the step that failed are in the table
  file("shear.toml", moving_case());
  const std::string diverging =
      "simulate shear.toml --algorithm enriched --eta 1e-4 --iterations 8 -o bad.h5 --convergence bad.csv";
  CHECK(run(diverging).exit_code == 1);
  const CsvTable before = csv("bad.csv");
  REQUIRE(!before.rows.empty());
  CHECK(before.text(before.rows.size() - 1, "step") ==
        std::to_string(nscdd::read_last_step(path("bad.h5")).state.step + 1));
  ended(1, diverging + " --restart");
  CHECK(csv("bad.csv").rows.size() == before.rows.size());
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a restart refuses a table that lacks steps, or is of another run") {
  const std::string restart = " --restart -o run.h5 --convergence ";
  answer("simulate shear.toml --steps 2 -o run.h5 --convergence one.csv");
  answer("simulate shear.toml --steps 4" + restart + "two.csv");
  check_refused("simulate shear.toml --steps 5" + restart + "one.csv",
                {"one.csv: expected rows of step 3 of the run in run.h5 up to its last iteration", "met none"});
  answer("simulate shear.toml --steps 5" + restart + "two.csv");
  CHECK(csv("two.csv").text(0, "step") == "3");
  answer("simulate shear.toml --steps 5 --iterations 3 -o other.h5 --convergence other.csv");
  check_refused("simulate shear.toml --steps 6" + restart + "other.csv",
                {"other.csv: expected rows of step 1 of the run in run.h5 up to", "met them up to 3"});
  file("twice.csv", replaced(read("two.csv"), "\n3,2,", "\n3,1,"));
  check_refused("simulate shear.toml --steps 6" + restart + "twice.csv",
                {"twice.csv: step 3: expected ascending iterations, met 1 after 1"});
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a run that replaces another and is killed goes on with its own table") {
  answer("simulate shear.toml --steps 4 -o whole.h5 --convergence whole.csv");
  answer("simulate shear.toml --steps 2 -o run.h5 --convergence run.csv");
  fs::rename(folder / "run.csv", folder / "run.csv.partial");  // as a kill leaves it
  file("run.csv", "step,iteration\n1,1\n");                    // that --force was to replace
  answer("simulate shear.toml --steps 4 --restart -o run.h5 --convergence run.csv");
  CHECK_FALSE(fs::exists(folder / "run.csv.partial"));
  const CsvTable whole = csv("whole.csv"), table = csv("run.csv");
  REQUIRE(table.rows.size() == whole.rows.size());
  for (std::size_t row = 0; row < whole.rows.size(); ++row) CHECK(table.text(row, "zeta") == whole.text(row, "zeta"));
}

TEST_CASE_FIXTURE(MovingSession, "simulate: names that a trajectory takes while it is written are none for its table") {
  fs::create_directory(folder / "store");
  fs::create_symlink("store/real.h5", folder / "link.h5");
  for (const std::string& ending : Texts{".next", ".previous", ".lock"}) {
    CAPTURE(ending);
    for (const std::string& name : Texts{"run.h5" + ending, "store/../run.h5" + ending})
      check_refused("simulate shear.toml --steps 2 -o run.h5 --convergence " + name,
                    {name, "expected another name", "run.h5 is written"});
    check_refused("simulate shear.toml -o link.h5 --convergence store/real.h5" + ending,
                  {"store/real.h5" + ending, "expected another name"});
  }
}

TEST_CASE_FIXTURE(Session, "simulate: a restart from another start is refused with the disk that differs") {
  const std::string rest =
      "\n[masses]\nmodel = \"unit\"\n[partition]\ngrid = [1, 1]\n[dynamics]\nsteps = 3\nstep = 0.01\n";
  file("two.csv", "x,y,radius\n0,0,1\n5,0,1\n");
  file("two.toml", "[packing]\nfile = \"two.csv\"" + rest);
  answer("simulate two.toml -o run.h5 --save-every 3");
  file("two.csv", "x,y,radius\n0,0,1\n5,0.5,1\n");
  check_refused("simulate two.toml --steps 4 --restart -o run.h5",
                {"run.h5", "met disk 1 elsewhere", "at (5, 0.5) m instead of (5, 0) m"});
  file("two.csv", "x,y,radius\n0,0,1\n5,0,1\n");
  answer("simulate two.toml --steps 4 --restart -o run.h5");
}

TEST_CASE_FIXTURE(Session, "simulate: what does not fit together names the file, the option or the key") {
  file("shear.toml", replaced(moving_case(), "\"zeta\"", "\"gluing\""));
  check_refused("simulate shear.toml --algorithm nlgs -o run.h5",
                {"shear.toml:21: solver.criterion: expected solver.algorithm generic, enriched or schwarz"});
  file("shear.toml", moving_case() + "\n[[prescribed]]\ngrain = 1000\nvelocity = [0, 0]\n");
  check_refused("simulate shear.toml -o run.h5", {"shear.toml:46: prescribed[0].grain: expected"});
  file("shear.toml", moving_case());
  answer("simulate shear.toml --steps 2 -o run.h5");
  check_refused("export run.h5 --fclib 2 --subdomain 99 -o part.hdf5",
                {"--subdomain: run.h5: step 2: expected a subdomain that has contacts", "met 99"});
}
