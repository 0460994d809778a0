// SPDX-License-Identifier: GPL-3.0-or-later
// `nscdd solve FOLDER --csv`: contact problems by contact solvers.
#include "../support/fclib_files.hpp"
#include "../support/spoilt.hpp"
#include "session.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>

#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// A folder with a global problem, a local one, and a file that is none.
struct TrialSession : Session {
  TrialSession() {
    file("problems/b.hdf5", raw_global(random_bodies_problem(4, 12, 20)).bytes());
    file("problems/c.h5", raw_local(reduce(random_bodies_problem(7, 12, 24))).bytes());
    file("problems/a.hdf5", "no HDF5 at all\n");
    file("problems/notes.txt", "not looked at\n");
  }
};

const std::set<std::string> timed{"seconds", "check_seconds", "seconds_1e-04", "seconds_1e-06", "seconds_1e-08"};

// The rows without what differs from run to run.
std::string without_seconds(const CsvTable& table) {
  std::string text;
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    for (const std::string& column : table.columns)
      if (!timed.contains(column)) text += table.text(i, column) + (column == table.columns.back() ? "\n" : ",");
  return text;
}

}  // namespace

TEST_CASE_FIXTURE(TrialSession, "solve FOLDER: a row per problem and solver, an unreadable file costs no other") {
  const Outcome run = ended(1, "solve problems --solver all --csv table.csv",
                            {"refused: problems/a.hdf5: ", "1 of 3 problems were refused: see the column 'status'"});
  const CsvTable rows = csv("table.csv");
  const std::vector<std::string> solvers = all_names<FrictionAlgorithm>();
  REQUIRE(rows.rows.size() == 3 * solvers.size());
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    CAPTURE(i);
    const std::size_t problem = i / solvers.size();
    CHECK(rows.text(i, "problem") == std::vector<std::string>{"a.hdf5", "b.hdf5", "c.h5"}[problem]);
    CHECK(rows.text(i, "solver") == solvers[i % solvers.size()]);
    if (problem == 0) {
      CHECK(rows.text(i, "status") == "refused");
      CHECK(rows.text(i, "seconds") == "nan");
      continue;
    }
    CHECK(rows.number(i, "contacts") == (problem == 1 ? 20 : 24));
    CHECK(rows.text(i, "status") == "converged");
    CHECK(rows.number(i, "residual") <= 1e-8);
    CHECK(rows.number(i, "work_1e-08") <= rows.number(i, "work"));
    // What `solve` says of the same problem.
    const std::string own =
        answer("solve problems/" + rows.text(i, "problem") + " --solver " + solvers[i % solvers.size()]);
    CHECK(contains(own, "sweeps               " + rows.text(i, "sweeps") + "\n"));
  }
  // The summary counts what was brought to each residual.
  for (const std::string& solver : solvers) {
    CAPTURE(solver);
    CHECK(contains(run.standard_output, solver + std::string(18 - solver.size(), ' ') + "       2       2       2"));
  }
}

TEST_CASE_FIXTURE(TrialSession, "solve FOLDER: a killed run goes on, and a limit of time is a status") {
  const std::string work = "solve problems --solver nlgs --solver auto --csv t.csv";
  REQUIRE(run(work, {.signal_at = SignalAt{"t.csv.partial", 300, SIGKILL}}).exit_code == 128 + SIGKILL);
  REQUIRE(has("t.csv.partial"));
  check_refused(work, {"--resume continues it"});
  check_refused(work + " --resume --tolerance 1e-6", {"choice of solver options", "tolerance"});
  check_refused(work + " --resume --time-limit 3", {"choice of solver options", "time_limit"});
  CHECK(run(work + " --resume").exit_code == 1);
  CHECK(!has("t.csv.record"));
  run("solve problems --solver nlgs --solver auto --csv whole.csv");
  CHECK(without_seconds(csv("t.csv")) == without_seconds(csv("whole.csv")));
  CHECK(contains(run(work + " --resume").standard_error, "already complete"));

  const CsvTable late = table("solve problems/c.h5 --solver nlgs --time-limit 1e-9");
  REQUIRE(late.rows.size() == 1);
  CHECK(late.text(0, "status") == "time_limit");
  CHECK(late.text(0, "seconds_1e-08") == "nan");
}

TEST_CASE_FIXTURE(Session, "solve --csv: velocities whose squares vanish are refused, as without it") {
  LocalFrictionProblem problem = reduce(random_bodies_problem(4, 12, 20));
  problem.q *= 1e-170;
  file("small.hdf5", raw_local(problem).bytes());
  check_refused("solve small.hdf5", {"small.hdf5: largest |q|"});
  ended(1, "solve small.hdf5 --csv t.csv", {"refused: small.hdf5: largest |q|"});
  CHECK(csv("t.csv").text(0, "status") == "refused");
}

TEST_CASE_FIXTURE(Session, "solve --csv: --resume refuses contacts of LMGC90 beside other bodies") {
  std::filesystem::copy(source_folder() / "tests/data/lmgc90/square_on_plank", folder / "net");
  const std::string work = "solve net --solver nlgs --solver auto --csv t.csv";
  REQUIRE(run(work, {.signal_at = SignalAt{"t.csv.partial", 300, SIGKILL}}).exit_code == 128 + SIGKILL);
  const std::string bulk = read("net/BULK_BEHAV.DAT");
  file("net/BULK_BEHAV.DAT", replaced(bulk, "Umas= 0.3000000D+01", "Umas= 0.4000000D+01"));
  check_refused(work + " --resume", {"t.csv", "net"});
  file("net/BULK_BEHAV.DAT", bulk);
  run(work + " --resume");
  CHECK(csv("t.csv").rows.size() == 2);
}

TEST_CASE_FIXTURE(TrialSession, "solve FOLDER: what is asked for must make sense") {
  file("empty/notes.txt", "\n");
  check_refused("solve problems", {"problems: expected a file, or a folder together with --csv"});
  check_refused("solve empty --csv t.csv", {"empty: expected a folder with contact problems, .hdf5, .h5 or .dat"});
  check_refused("solve problems/b.hdf5 --solver all", {"--solver: expected one, or several with --csv"});
  check_refused("solve problems --solver nlgs --solver nlgs --csv t.csv", {"each solver once", "'nlgs'"});
  check_refused("solve problems --solver newtn --csv t.csv", {"--solver", "one of \"auto\""});
  check_refused("solve problems --time-limit 0 --csv t.csv",
                {"--time-limit: expected a finite number > 0, or inf, met 0"});
  check_refused("solve problems/b.hdf5 --time-limit 1", {"--time-limit", "--csv"});
  check_refused("solve problems --csv t.csv --guess 1", {"--guess", "--csv"});
  check_refused("solve problems/b.hdf5 --csv problems/b.hdf5 --force", {"problems/b.hdf5"});
}
