// SPDX-License-Identifier: GPL-3.0-or-later
// `nscdd solve FOLDER --csv`: contact problems by contact solvers.
#include "../support/fclib_files.hpp"
#include "session.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>

#include <doctest/doctest.h>

#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// A folder with a global problem, a local one, and a file that is none.
void make_problems(const Session& session) {
  session.file("problems/b.hdf5", raw_global(random_bodies_problem(4, 12, 20)).bytes());
  session.file("problems/c.h5", raw_local(reduce(random_bodies_problem(7, 12, 24))).bytes());
  session.file("problems/a.hdf5", "no HDF5 at all\n");
  session.file("problems/notes.txt", "not looked at\n");
}

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

TEST_CASE("solve FOLDER: a row per problem and solver, and a file that cannot be read costs no other") {
  const Session session;
  make_problems(session);
  const Outcome run = session.run(words("solve problems --solver all --csv table.csv"));
  CHECK(run.exit_code == 1);
  CHECK(contains(run.standard_error, "refused: problems/a.hdf5: "));
  CHECK(contains(run.standard_error, "1 of 3 problems were refused: see the column 'status'"));
  const CsvTable rows = read_table(session.read("table.csv"));
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
        answer(session, "solve problems/" + rows.text(i, "problem") + " --solver " + solvers[i % solvers.size()]);
    CHECK(contains(own, "sweeps               " + rows.text(i, "sweeps") + "\n"));
  }
  // The summary counts what was brought to each residual.
  for (const std::string& solver : solvers) {
    CAPTURE(solver);
    CHECK(contains(run.standard_output, solver + std::string(18 - solver.size(), ' ') + "       2       2       2"));
  }
}

TEST_CASE("solve FOLDER: a killed run goes on, and a limit of time is a status") {
  const Session session;
  make_problems(session);
  const std::string work = "solve problems --solver nlgs --solver auto --csv t.csv";
  REQUIRE(session.run(words(work), {.signal_at = SignalAt{"t.csv.partial", 300, SIGKILL}}).exit_code == 128 + SIGKILL);
  REQUIRE(session.has("t.csv.partial"));
  check_refused(session, work, {"--resume continues it"});
  check_refused(session, work + " --resume --tolerance 1e-6", {"choice of solver options", "tolerance"});
  check_refused(session, work + " --resume --time-limit 3", {"choice of solver options", "time_limit"});
  CHECK(session.run(words(work + " --resume")).exit_code == 1);
  CHECK(!session.has("t.csv.record"));
  session.run(words("solve problems --solver nlgs --solver auto --csv whole.csv"));
  CHECK(without_seconds(read_table(session.read("t.csv"))) == without_seconds(read_table(session.read("whole.csv"))));
  CHECK(contains(session.run(words(work + " --resume")).standard_error, "already complete"));

  const CsvTable late = table(session, "solve problems/c.h5 --solver nlgs --time-limit 1e-9");
  REQUIRE(late.rows.size() == 1);
  CHECK(late.text(0, "status") == "time_limit");
  CHECK(late.text(0, "seconds_1e-08") == "nan");
}

TEST_CASE("solve FOLDER: what is asked for must make sense") {
  const Session session;
  make_problems(session);
  session.file("empty/notes.txt", "\n");
  check_refused(session, "solve problems", {"problems: expected a file, or a folder with --csv"});
  check_refused(session, "solve empty --csv t.csv",
                {"empty: expected a folder with contact problems, .hdf5, .h5 or .dat"});
  check_refused(session, "solve problems/b.hdf5 --solver all", {"--solver: expected one, or several with --csv"});
  check_refused(session, "solve problems --solver nlgs --solver nlgs --csv t.csv", {"each solver once", "'nlgs'"});
  check_refused(session, "solve problems --solver newtn --csv t.csv", {"--solver", "one of \"auto\""});
  check_refused(session, "solve problems --time-limit 0 --csv t.csv",
                {"--time-limit: expected a finite number > 0, or inf, met 0"});
  check_refused(session, "solve problems/b.hdf5 --time-limit 1", {"--time-limit", "--csv"});
  check_refused(session, "solve problems --csv t.csv --guess 1", {"--guess", "--csv"});
  check_refused(session, "solve problems/b.hdf5 --csv problems/b.hdf5 --force", {"problems/b.hdf5"});
}
