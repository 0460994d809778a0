// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd simulate: links to a trajectory, names beside it, the table that a restart goes on with.
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"
#include <nscdd/core/table.hpp>

#include <doctest/doctest.h>

#include <filesystem>

using namespace nscdd::testing;
namespace fs = std::filesystem;

namespace {

struct MovingSession : Session {
  MovingSession() { file("shear.toml", moving_case()); }
  nscdd::Index last_step(const std::string& name) const {
    return nscdd::read_last_step((folder / name).string()).state.step;
  }
};

}  // namespace

TEST_CASE("simulate: through a symbolic link the trajectory it leads to is written, whole, and stays linked") {
  const MovingSession session;
  fs::create_directory(session.folder / "store");
  answer(session, "simulate shear.toml --steps 2 -o store/real.h5");
  fs::create_symlink("store/real.h5", session.folder / "first.h5");
  fs::create_symlink("first.h5", session.folder / "link.h5");
  answer(session, "simulate shear.toml --steps 4 --restart -o link.h5");
  CHECK(fs::is_symlink(session.folder / "link.h5"));
  CHECK(session.last_step("store/real.h5") == 4);
  answer(session, "simulate shear.toml --steps 4 -o plain.h5");
  CHECK(nscdd::read_last_step((session.folder / "store/real.h5").string()).state.x ==
        nscdd::read_last_step((session.folder / "plain.h5").string()).state.x);
  session.file("store/real.h5.next", "mine");
  check_refused(session, "simulate shear.toml --steps 5 --restart -o link.h5", {"store/real.h5.next", "move it away"});
}

TEST_CASE("simulate: a second name of a trajectory keeps the version it has") {
  const MovingSession session;
  answer(session, "simulate shear.toml --steps 2 -o run.h5");
  fs::create_hard_link(session.folder / "run.h5", session.folder / "kept.h5");
  const std::string before = session.read("kept.h5");
  answer(session, "simulate shear.toml --steps 5 --restart -o run.h5");
  CHECK(session.read("kept.h5") == before);
  CHECK(session.last_step("run.h5") == 5);
}

TEST_CASE("simulate: a trajectory of another build of the program is not gone on with") {
  const MovingSession session;
  answer(session, "simulate shear.toml --steps 2 -o run.h5");
  const std::string build = nscdd::build_fingerprint(), other(build.size(), 'x');
  session.file("run.h5", replaced(session.read("run.h5"), build, other));
  check_refused(session, "simulate shear.toml --steps 4 --restart -o run.h5", {"run.h5", "build", build, other});
}

TEST_CASE("simulate: a restart that is refused for its table leaves the trajectory as it was") {
  const MovingSession session;
  answer(session, "simulate shear.toml --steps 2 -o run.h5");
  session.file("foreign.csv.partial", "a,b\n1,2\n");
  check_refused(session, "simulate shear.toml --steps 4 --restart -o run.h5 --convergence foreign.csv",
                {"foreign.csv.partial", "met other columns"});
  session.file("both.csv", "mine");
  session.file("both.csv.partial", "");
  check_refused(session, "simulate shear.toml --steps 4 --restart -o run.h5 --convergence both.csv",
                {"both.csv", "exists already"});
}

TEST_CASE("simulate: a restart drops the rows of the step that broke down") {
  const Session session;
  session.file("worse.toml",
               replaced(moving_case(), "spin = -0.075", "motion = [[0.05, 0, 0, 0], [0.051, 1e6, 0, 0]]"));
  const auto row_count = [&] { return read_table(session.read("rows.csv")).rows.size(); };
  CHECK(session.run(words("simulate worse.toml -o run.h5 --convergence rows.csv")).exit_code == 1);
  const auto first = row_count();
  CHECK(session.run(words("simulate worse.toml --restart -o run.h5 --convergence rows.csv")).exit_code == 1);
  CHECK(row_count() == first);
  // where iterations of the step that failed are in the table
  session.file("shear.toml", moving_case());
  const std::string diverging =
      "simulate shear.toml --algorithm enriched --eta 1e-4 --iterations 8 -o bad.h5 --convergence bad.csv";
  CHECK(session.run(words(diverging)).exit_code == 1);
  const CsvTable before = read_table(session.read("bad.csv"));
  REQUIRE(!before.rows.empty());
  CHECK(before.text(before.rows.size() - 1, "step") ==
        std::to_string(nscdd::read_last_step((session.folder / "bad.h5").string()).state.step + 1));
  const Outcome again = session.run(words(diverging + " --restart"));
  CHECK(again.exit_code == 1);
  CHECK(read_table(session.read("bad.csv")).rows.size() == before.rows.size());
}

TEST_CASE("simulate: a restart does not go on with a table that lacks steps, or is of another run") {
  const MovingSession session;
  const std::string restart = " --restart -o run.h5 --convergence ";
  answer(session, "simulate shear.toml --steps 2 -o run.h5 --convergence one.csv");
  answer(session, "simulate shear.toml --steps 4" + restart + "two.csv");
  check_refused(session, "simulate shear.toml --steps 5" + restart + "one.csv",
                {"one.csv: expected rows of step 3 of the run in run.h5 up to its last iteration", "met none"});
  answer(session, "simulate shear.toml --steps 5" + restart + "two.csv");
  CHECK(read_table(session.read("two.csv")).text(0, "step") == "3");
  answer(session, "simulate shear.toml --steps 5 --iterations 3 -o other.h5 --convergence other.csv");
  check_refused(session, "simulate shear.toml --steps 6" + restart + "other.csv",
                {"other.csv: expected rows of step 1 of the run in run.h5 up to", "met them up to 3"});
  session.file("twice.csv", replaced(session.read("two.csv"), "\n3,2,", "\n3,1,"));
  check_refused(session, "simulate shear.toml --steps 6" + restart + "twice.csv",
                {"twice.csv: step 3: expected ascending iterations, met 1 after 1"});
}

TEST_CASE("simulate: a run that replaces another and is killed goes on with its own table") {
  const MovingSession session;
  answer(session, "simulate shear.toml --steps 4 -o whole.h5 --convergence whole.csv");
  answer(session, "simulate shear.toml --steps 2 -o run.h5 --convergence run.csv");
  fs::rename(session.folder / "run.csv", session.folder / "run.csv.partial");  // as a kill leaves it
  session.file("run.csv", "step,iteration\n1,1\n");                            // that --force was to replace
  answer(session, "simulate shear.toml --steps 4 --restart -o run.h5 --convergence run.csv");
  CHECK_FALSE(fs::exists(session.folder / "run.csv.partial"));
  const CsvTable whole = read_table(session.read("whole.csv")), table = read_table(session.read("run.csv"));
  REQUIRE(table.rows.size() == whole.rows.size());
  for (std::size_t row = 0; row < whole.rows.size(); ++row) CHECK(table.text(row, "zeta") == whole.text(row, "zeta"));
}

TEST_CASE("simulate: names that the trajectory takes while it is written are no names for its table") {
  const MovingSession session;
  fs::create_directory(session.folder / "store");
  fs::create_symlink("store/real.h5", session.folder / "link.h5");
  for (const std::string& ending : Texts{".next", ".previous", ".lock"}) {
    CAPTURE(ending);
    for (const std::string& name : Texts{"run.h5" + ending, "store/../run.h5" + ending})
      check_refused(session, "simulate shear.toml --steps 2 -o run.h5 --convergence " + name,
                    {name, "expected another name", "run.h5 is written"});
    check_refused(session, "simulate shear.toml -o link.h5 --convergence store/real.h5" + ending,
                  {"store/real.h5" + ending, "expected another name"});
  }
}

TEST_CASE("simulate: a restart from another start is refused with the disk that differs") {
  const Session session;
  const std::string rest =
      "\n[masses]\nmodel = \"unit\"\n[partition]\ngrid = [1, 1]\n[dynamics]\nsteps = 3\nstep = 0.01\n";
  session.file("two.csv", "x,y,radius\n0,0,1\n5,0,1\n");
  session.file("two.toml", "[packing]\nfile = \"two.csv\"" + rest);
  answer(session, "simulate two.toml -o run.h5 --save-every 3");
  session.file("two.csv", "x,y,radius\n0,0,1\n5,0.5,1\n");
  check_refused(session, "simulate two.toml --steps 4 --restart -o run.h5",
                {"run.h5", "met disk 1 elsewhere", "at (5, 0.5) m instead of (5, 0) m"});
  session.file("two.csv", "x,y,radius\n0,0,1\n5,0,1\n");
  answer(session, "simulate two.toml --steps 4 --restart -o run.h5");
}

TEST_CASE("simulate: what does not fit together names the file, the option or the key") {
  const Session session;
  session.file("shear.toml", replaced(moving_case(), "\"zeta\"", "\"gluing\""));
  check_refused(session, "simulate shear.toml --algorithm nlgs -o run.h5",
                {"shear.toml:21: solver.criterion: expected solver.algorithm generic or enriched"});
  session.file("shear.toml", moving_case() + "\n[[prescribed]]\ngrain = 1000\nvelocity = [0, 0]\n");
  check_refused(session, "simulate shear.toml -o run.h5", {"shear.toml:46: prescribed[0].grain: expected"});
  session.file("shear.toml", moving_case());
  answer(session, "simulate shear.toml --steps 2 -o run.h5");
  check_refused(session, "export run.h5 --fclib 2 --subdomain 99 -o part.hdf5",
                {"--subdomain: run.h5: step 2: expected a subdomain that has contacts", "met 99"});
}
