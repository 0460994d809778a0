// SPDX-License-Identifier: GPL-3.0-or-later
// Long work: what an interrupted run leaves, and that going on gives what a run in one piece gives.
#include "files/csv.hpp"
#include "session.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>

using namespace nscdd::testing;

namespace {

// About two seconds of work: 1 500 rows of 400 disks.
const std::string work =
    "sweep hexagonal --set packing.columns=20 --set packing.rows=20 --epsilon 1e-3:1e3:750 --eta 0.1,inf "
    "--csv long.csv";

// A signal after some rows of a table.
RunOptions stopped(const std::string& file, int signal, std::size_t bytes = 8000) {
  return {.signal_at = SignalAt{file, bytes, signal}};
}

// The work killed after some rows.
void kill_work(const Session& session, const std::string& line = work) {
  REQUIRE(session.run(line, stopped("long.csv.partial", SIGKILL)).exit_code == 128 + SIGKILL);
  REQUIRE(session.has("long.csv.partial"));
  REQUIRE(session.has("long.csv.record"));
  REQUIRE(!session.has("long.csv"));
}

std::size_t files(const Session& session) { return content_of(session.folder.path()).size(); }

const std::string study_text = R"(title = "two tables"
[[table]]
name = "first"
cases = ["disks4"]
vary = { "packing.grains" = [4, 6] }
epsilon = "0,1e-2:1e2:20"

[[table]]
name = "second"
cases = ["hexagonal"]
vary = { "packing.columns" = [12, 20] }
epsilon = "1e-3:1e3:300"
eta = "0.1,inf"

[[table]]
name = "third"
observable = "links"
cases = ["disks4"]
)";

}  // namespace

TEST_CASE_FIXTURE(Session, "resume: a killed sweep ends as one in one piece, byte for byte") {
  const Session whole;
  whole.answer(work);
  kill_work(*this);
  const std::string before = read("long.csv.partial");
  // it is gone on with, not begun again: killed once more, the rows there were still lead
  REQUIRE(run(work + " --resume", stopped("long.csv.partial", SIGKILL)).exit_code == 128 + SIGKILL);
  CHECK(read("long.csv.partial").rfind(before.substr(0, before.rfind('\n') + 1), 0) == 0);
  answer(work + " --resume");
  CHECK(read("long.csv") == whole.read("long.csv"));
  CHECK(files(*this) == 1);
}

TEST_CASE_FIXTURE(Session, "resume: Ctrl-C and SIGTERM leave whole rows, say how to go on and exit with 130") {
  const Session whole;
  whole.answer(work);
  std::string line = work;
  for (const int signal : {SIGINT, SIGTERM}) {
    CAPTURE(signal);
    const Outcome outcome = ended(130, line, {}, stopped("long.csv.partial", signal));
    CHECK(outcome.standard_output == "");
    const std::string rows = read("long.csv.partial");
    CHECK(rows.back() == '\n');
    const auto count = read_table(rows).rows.size();
    CHECK(contains(outcome.standard_error,
                   "long.csv: interrupted after " + std::to_string(count) + " of 1500 rows; --resume"));
    line = work + " --resume";
  }
  answer(line);
  CHECK(read("long.csv") == whole.read("long.csv"));
  CHECK(files(*this) == 1);
}

TEST_CASE_FIXTURE(Session, "resume: Ctrl-C of a sweep to standard output exits with 130") {
  fs::create_symlink("/dev/null", folder / "sink");
  const Outcome outcome = ended(130, "sweep disks4 --epsilon 1e-3:1e3:1000000 --csv sink --hdf5 out.h5",
                                {"sink: interrupted after "}, stopped("null", SIGINT));
  CHECK(!contains(outcome.standard_error, "--resume"));
  CHECK(files(*this) == 1);
}

TEST_CASE_FIXTURE(Session, "resume: a line cut short is computed again") {
  const Session whole;
  whole.answer(work);
  kill_work(*this);
  std::string rows = read("long.csv.partial");
  rows.resize(rows.rfind('\n') + 1);
  for (const std::string& cut :
       Texts{rows + "hexagonal,400,11", rows + "hexagonal,400,1141\n", rows.substr(0, rows.size() - 1)}) {
    file("long.csv.partial", cut);
    answer(work + " --resume");
    CHECK(read("long.csv") == whole.read("long.csv"));
    CHECK(files(*this) == 1);
    fs::remove(folder / "long.csv");
    kill_work(*this);
  }
}

TEST_CASE_FIXTURE(Session, "resume: HDF5 holds the rows found and the rows computed") {
  const Session whole;
  const std::string line = work + " --hdf5 long.h5";
  whole.answer(line + " --resume");  // nothing there: from the start
  kill_work(*this, line);
  answer(line + " --resume");
  CHECK(read("long.h5") == whole.read("long.h5"));
  CHECK(read("long.csv") == whole.read("long.csv"));
  CHECK(files(*this) == 2);
}

TEST_CASE_FIXTURE(Session, "resume: other work is refused, naming what differs, and nothing is touched") {
  kill_work(*this);
  const auto refused = [&](const std::string& line, std::initializer_list<std::string> parts) {
    check_refused(line + " --resume", parts);
  };
  refused(work + " --set contacts.tolerance=1e-6", {"long.csv.partial", "the case differs", "1e-06"});
  refused(work + " --density 2", {"the case differs", "density = 2500", "density = 2"});
  refused(replaced(work, "1e3:750", "1e3:751"), {"options differs", "750 values", "751 values"});
  refused(replaced(work, "0.1,inf", "0.2,inf"), {"options differs", "[0.1, inf]", "[0.2, inf]"});
  refused(work + " --contacts active", {"options differs", "contacts = all", "contacts = active"});
  refused(work + " --solver dense", {"solver options differs", "solver = \"auto\"", "solver = \"dense\""});
  refused(work + " --residual-tolerance 1e-6", {"solver options differs", "tolerance"});
  const std::string record = read("long.csv.record");
  const auto build = record.find("build ") + 6;
  file("long.csv.record", record.substr(0, build) + "0123456789abcdef" + record.substr(build + 16));
  refused(work, {"code version differs", "build 0123456789abcdef"});
  file("long.csv.record", replaced(record, "Eigen 3", "Eigen 2"));
  refused(work, {"code version differs", "Eigen 2"});
  file("long.csv.record", "nonsense");
  refused(work, {"long.csv.record:1", "--force starts again"});
  file("long.csv.record", "");
  refused(work, {"long.csv.record", "--force starts again"});
  fs::remove(folder / "long.csv.record");
  refused(work, {"long.csv.record", "--force"});
}

TEST_CASE_FIXTURE(Session, "resume: an edited packing file is another case, the same one elsewhere is not") {
  std::string packing = "x,y,radius\n";
  for (int i = 0; i < 300; ++i) packing += std::to_string(i) + ",0,0.5\n";
  file("mine.csv", packing);
  const std::string line = "sweep mine.csv --subdomains 30x1 --epsilon 1e-3:1e3:20000 --csv long.csv";
  kill_work(*this, line);
  file("mine.csv", replaced(packing, "\n7,0,0.5\n", "\n7,0,0.50000001\n"));
  check_refused(line + " --resume", {"the case differs", "300 grains, content"});
  file("elsewhere/mine.csv", packing);
  ended(130, replaced(line, "mine.csv", "elsewhere/mine.csv") + " --resume", {},
        stopped("long.csv.partial", SIGINT, 1));
}

TEST_CASE_FIXTURE(Session, "resume: rows that are not those of the sweep are refused") {
  kill_work(*this);
  const std::string rows = read("long.csv.partial");
  const auto first = rows.find('\n') + 1, second = rows.find('\n', first) + 1, third = rows.find('\n', second) + 1;
  file("long.csv.partial", rows.substr(0, first) + rows.substr(second));
  check_refused(work + " --resume", {"long.csv.partial:2", "eta", "0.1", "inf"});
  file("long.csv.partial", replaced(rows, "spectral_radius", "radius"));
  check_refused(work + " --resume", {"long.csv.partial:1", "columns"});
  file("long.csv.partial", rows.substr(0, second) + "hexagonal,x\n" + rows.substr(third));
  check_refused(work + " --resume", {"long.csv.partial:3", "values"});
}

TEST_CASE_FIXTURE(Session, "resume: without --resume the rows of an interrupted run are safe") {
  kill_work(*this);
  const std::string table = read("long.csv.partial");
  const auto rows = std::count(table.begin(), table.end(), '\n') - 1;  // the last line is cut short
  check_refused(work, {"long.csv.partial", std::to_string(rows) + " row(s) of an interrupted run", "--resume",
                       "--force starts again"});
  answer("sweep disks4 --epsilon 1 --csv long.csv --force");
  CHECK(csv("long.csv").rows.size() == 1);
  CHECK(files(*this) == 1);
}

TEST_CASE_FIXTURE(Session, "resume: a complete table is left alone") {
  const std::string line = "sweep disks4 --epsilon 0,1 --csv long.csv";
  answer(line + " --resume");
  const std::string rows = read("long.csv");
  ended(0, line + " --resume", {"already complete"});
  CHECK(read("long.csv") == rows);
  CHECK(files(*this) == 1);
  check_refused(line + " --hdf5 a.h5 --resume", {"long.csv", "a.h5", "--force"});
  check_refused("sweep disks4 --epsilon 0,2 --csv long.csv --resume", {"long.csv:3: epsilon", "2", "--force"});
  check_refused("sweep disks4 --epsilon 0 --csv long.csv --resume", {"long.csv", "1 rows", "--force"});
  check_refused("sweep disks8 --epsilon 0,1 --csv long.csv --resume", {"long.csv:2: case", "disks8", "--force"});
  check_refused("optimum disks4 --epsilon 1 --csv long.csv --resume", {"long.csv:1", "columns", "--force"});
}

TEST_CASE_FIXTURE(Session, "resume: an older table is replaced only where --force says so, and only when all is done") {
  const Session whole;
  whole.answer(work);
  file("long.csv", "precious");
  REQUIRE(run(work + " --force", stopped("long.csv.partial", SIGKILL)).exit_code == 128 + SIGKILL);
  CHECK(read("long.csv") == "precious");
  check_refused(work + " --resume", {"long.csv: exists already", "--force"});
  answer(work + " --resume --force");
  CHECK(read("long.csv") == whole.read("long.csv"));
  CHECK(files(*this) == 1);
}

TEST_CASE_FIXTURE(Session, "resume: standard output and reports keep nothing") {
  check_refused("sweep disks4 --epsilon 1 --csv - --resume", {"--resume", "file"});
  check_refused("optimum disks4 --resume", {"--resume", "--csv"});
}

TEST_CASE_FIXTURE(Session, "resume: two runs never write one table") {
  bool refused = false;
  SignalAt first_rows{"long.csv.partial", 1, SIGSTOP};
  first_rows.while_stopped = [&] {
    const Outcome second = run(work + " --resume");
    refused = second.exit_code == 2 && contains(second.standard_error, "another run");
  };
  CHECK(run(work, {.signal_at = first_rows}).exit_code == 128 + SIGKILL);
  CHECK(refused);
}

TEST_CASE_FIXTURE(Session, "resume: a killed table of optima or of coarse spaces ends as one in one piece") {
  for (const std::string& line : Texts{"optimum disks8 --epsilon 0,1e-3:1e3:60 --contacts all --csv long.csv",
                                       "coarse disks8 --epsilon 1e-3:1e3:60 --csv long.csv"}) {
    const Session whole, killed;
    whole.answer(line);
    kill_work(killed, line);
    killed.answer(line + " --resume");
    CHECK(killed.read("long.csv") == whole.read("long.csv"));
    CHECK(files(killed) == 1);
  }
}

TEST_CASE_FIXTURE(Session, "resume: a killed study ends as one in one piece") {
  const Session whole;
  whole.file("study/study.toml", study_text);
  file("study/study.toml", study_text);
  whole.answer("run study --resume");
  const std::string results = "results/study/";
  for (const int signal : {SIGKILL, SIGINT}) {
    CAPTURE(signal);
    ended(signal == SIGKILL ? 128 + SIGKILL : 130, "run study --resume", {}, stopped("second.csv.partial", signal));
    CHECK(has(results + "first.csv"));
    CHECK(has(results + "first.csv.record"));
    CHECK(!has(results + "second.csv"));
    CHECK(!has(results + "study.h5"));
  }
  check_refused("run study", {"first.csv", "exists already"});
  const std::string first = read(results + "first.csv");
  file(results + "first.csv", first + "\n");
  check_refused("run study --resume", {"first.csv", "--force"});
  file(results + "first.csv", first);
  file("study/study.toml", replaced(study_text, "1e3:300", "1e3:301"));
  check_refused("run study --resume", {"second.csv.partial", "options differs"});
  file("study/study.toml", replaced(study_text, "1e2:20", "1e2:21"));
  check_refused("run study --resume", {"first.csv", "options differs"});
  file("study/study.toml", study_text);
  answer("run study --resume");
  CHECK(content_of(folder.path()) == content_of(whole.folder.path()));  // HDF5 included
}

TEST_CASE_FIXTURE(Session, "resume: a complete study is left alone, and may be checked") {
  file("study/study.toml", study_text);
  answer("run study");
  const auto before = content_of(folder.path());
  ended(0, "run study --resume", {"already complete"});
  CHECK(content_of(folder.path()) == before);
  for (const auto& [old, other] : {std::pair{"1e2:20", "1e2:21"}, std::pair{"1e-2:1e2:20", "1e-2:1e3:20"}}) {
    file("study/study.toml", replaced(study_text, old, other));
    check_refused("run study --resume", {"results/study/first.csv", "--force replaces"});
  }
  file("study/study.toml", study_text);
  for (const std::string& name : Texts{"second", "third"})
    file("study/baseline-" + name + ".csv", read("results/study/" + name + ".csv"));
  file("study/baseline.csv", read("results/study/first.csv"));
  CHECK(run("run study --resume --check").exit_code == 0);
  file("study/baseline-second.csv", read("results/study/first.csv"));
  CHECK(run("run study --resume --check").exit_code == 1);
}

TEST_CASE_FIXTURE(Session, "resume: a complete table of runs is of its seed") {
  const std::string text =
      "[[table]]\nname = \"rate\"\nobservable = \"observed_rate\"\ncases = [\"disks4\"]\nepsilon = 1\n";
  file("study/study.toml", text + "seed = 2\n");
  answer("run study");
  ended(0, "run study --resume", {"already complete"});
  file("study/study.toml", text + "seed = 3\n");
  check_refused("run study --resume", {"rate.csv:2: seed", "3", "2", "--force"});
}

TEST_CASE_FIXTURE(Session, "progress: rate and time left on a terminal") {
  kill_work(*this);
  ended(0, work + " --resume", {" points/s, ", " s left"}, {.on_terminal = true});
}
