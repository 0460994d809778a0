// SPDX-License-Identifier: GPL-3.0-or-later
// Rows that were not proved are computed again, and only they.
#include "files/csv.hpp"
#include "files/hdf5.hpp"
#include "session.hpp"
#include <nscdd/core/table.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <fstream>

using namespace nscdd::testing;

namespace {

const std::string sweep_line = "sweep disks8 --epsilon 1e-2,1,10 --eta 0.3,inf --csv table.csv";

const std::string study_line = "run study --output out";

// A study of two cases, one with a comma in its name, and two values of a parameter; a table without rows to
// be proved stands beside it.
struct StudySession : Session {
  explicit StudySession(const std::string& points = "0.1,1,inf") {
    std::filesystem::create_directory(folder / "study");
    describe(points);
    weigh(1);
  }
  void describe(const std::string& points) const {
    file("study/study.toml",
         "title = \"A study to be repaired\"\n"
         "[[table]]\nname = \"radius\"\nobservable = \"spectral_radius\"\n"
         "cases = [\"one,two.toml\", \"plain.toml\"]\nepsilon = 1\neta = \"" +
             points + "\"\nvary = {\"packing.grains\" = [6, 9]}\n" +
             "[[table]]\nname = \"links\"\nobservable = \"links\"\ncases = [\"plain.toml\"]\n");
  }
  // The cases with grains of this density: other rows, of which nothing is known beforehand.
  void weigh(double density) const {
    for (const char* name : {"study/one,two.toml", "study/plain.toml"})
      file(name,
           "[packing]\ngenerator = \"strip\"\ngrains = 6\n[partition]\ngrid = [3, 1]\n"
           "[masses]\nmodel = \"density\"\ndensity = " +
               std::to_string(density) + "\n");
  }
  std::string rows() const { return read("out/study/radius.csv"); }

  // Results of which no row is proved, and whose rows are others.
  void spoil() const {
    weigh(2);
    REQUIRE(run(words(study_line + " --force")).exit_code == 0);
    std::string text = rows();
    for (auto at = text.find(",true"); at != std::string::npos; at = text.find(",true", at))
      text.replace(at, 5, ",false");
    file("out/study/radius.csv", text);
    weigh(1);
  }
};

// The tables of an HDF5 file as texts.
std::string tables_text(const std::string& bytes) {
  std::string text;
  for (const auto& [name, table] : nscdd::tables_from_hdf5(bytes, "study.h5").tables) {
    text += name;
    for (const auto& column : table.columns) text += ',' + column.name + ' ' + column.unit;
    for (const auto& row : table.rows)
      for (const auto& cell : row) text += '\n' + std::to_string(cell.index()) + ' ' + nscdd::to_text(cell);
  }
  return text;
}

void write(const Session& session, const std::string& text) {
  std::ofstream(session.folder / "table.csv", std::ios::binary) << text;
}

}  // namespace

TEST_CASE("redo: rows that did not converge are computed again, the others keep their bytes") {
  const Session session;
  REQUIRE(session.run(words(sweep_line)).exit_code == 0);
  const std::string proved = session.read("table.csv");
  REQUIRE(session.run(words(sweep_line + " --force --residual-tolerance 1e-30")).exit_code == 0);
  REQUIRE(session.read("table.csv") != proved);
  CHECK(session.run(words(sweep_line + " --redo")).exit_code == 0);
  CHECK(session.read("table.csv") == proved);
  // A row marked as proved is not touched, whatever it says; one that is not is.
  const std::string kept = replaced(proved, ",dense,", ",elsewhere,");
  write(session, kept);
  CHECK(contains(session.run(words(sweep_line + " --redo")).standard_error, "no row to compute again"));
  CHECK(session.read("table.csv") == kept);
  write(session, replaced(kept, ",true", ",false"));
  CHECK(session.run(words(sweep_line + " --redo")).exit_code == 0);
  CHECK(session.read("table.csv") == proved);
}

TEST_CASE("redo: a table of another sweep, an unfinished one and none are refused and stay") {
  const Session session;
  REQUIRE(session.run(words(sweep_line)).exit_code == 0);
  const std::string table = session.read("table.csv");
  for (const std::string line :
       {"sweep disks8 --epsilon 1e-2,1,11 --eta 0.3,inf --csv table.csv --redo",
        "sweep disks8 --epsilon 1e-2,1 --eta 0.3,inf --csv table.csv --redo",
        "sweep disks8 --epsilon 1e-2,1,10,100 --eta 0.3,inf --csv table.csv --redo",
        "sweep disks12 --epsilon 1e-2,1,10 --eta 0.3,inf --csv table.csv --redo",
        "sweep disks8 --epsilon 1e-2,1,10 --eta 0.3,inf --csv table.csv --redo --certify",
        "sweep disks8 --epsilon 1e-2,1,10 --eta 0.3,inf --csv table.csv --redo --hdf5 table.h5",
        "sweep disks8 --epsilon 1e-2,1,10 --eta 0.3,inf --csv - --redo",
        "sweep disks8 --epsilon 1e-2,1,10 --eta 0.3,inf --csv missing.csv --redo"}) {
    CAPTURE(line);
    CHECK(session.run(words(line)).exit_code == 2);
    CHECK(session.read("table.csv") == table);
  }
}

TEST_CASE("redo: what is done when it is interrupted is kept, the rest stays and can be redone") {
  const Session session;
  const std::string line = "sweep disks12 --epsilon 1e-3:1e3:3000 --csv table.csv";
  REQUIRE(session.run(words(line)).exit_code == 0);
  const std::string proved = session.read("table.csv");
  REQUIRE(session.run(words(line + " --force --residual-tolerance 1e-30")).exit_code == 0);
  const std::string unproved = session.read("table.csv");
  const RunOptions options{.signal_at = SignalAt{"table.csv.partial", 2000, SIGINT}};
  const Outcome outcome = session.run(words(line + " --redo"), options);
  CHECK(outcome.exit_code == 130);
  CHECK(outcome.standard_error.find("left as they were; --redo continues") != std::string::npos);
  CHECK(content_of(session.folder.path()).size() == 1);
  const std::string text = session.read("table.csv");
  const auto parted = std::mismatch(text.begin(), text.end(), proved.begin(), proved.end());
  const auto done = std::count(text.begin(), parted.first, '\n');
  const auto rest = [&](const std::string& rows) {
    std::size_t start = 0;
    for (auto k = done; k > 0; --k) start = rows.find('\n', start) + 1;
    return rows.substr(start);
  };
  CHECK(done > 2);
  CHECK(done < 3000);
  CHECK(rest(text) == rest(unproved));
  CHECK(session.run(words(line + " --redo")).exit_code == 0);
  CHECK(session.read("table.csv") == proved);
}

TEST_CASE("redo: with --certify rows that are not certified are computed again") {
  const Session session;
  const std::string line = "sweep disks8 --epsilon 1 --csv table.csv --certify";
  REQUIRE(session.run(words(line)).exit_code == 0);
  const std::string certified = session.read("table.csv");
  std::string doubtful = certified;
  const CsvTable rows = read_table(certified);
  REQUIRE(rows.text(0, "certified") == "true");
  write(session, doubtful.replace(doubtful.find(",true,true,"), 11, ",true,false,"));
  const Outcome outcome = session.run(words(line + " --redo"));
  CHECK(outcome.exit_code == 0);
  CHECK(session.read("table.csv") == certified);
}

TEST_CASE("redo: an empty interface is certified, there being nothing to miss") {
  const Session session;
  const std::string line = "sweep disks4 --subdomains 1x1 --epsilon 1 --csv table.csv --certify";
  const Outcome outcome = session.run(words(line));
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.standard_error.find("--redo") == std::string::npos);
  CHECK(read_table(session.read("table.csv")).text(0, "certified") == "true");
}

TEST_CASE("redo: a case name with a comma stays in quotes") {
  const Session session;
  session.file("one,two.toml", "[packing]\ngenerator = \"strip\"\ngrains = 6\n[partition]\ngrid = [3, 1]\n");
  const std::string line = "sweep one,two.toml --epsilon 1 --eta 0.3,inf --csv table.csv";
  REQUIRE(session.run(words(line)).exit_code == 0);
  const std::string proved = session.read("table.csv");
  REQUIRE(proved.find("\n\"one,two\",6,") != std::string::npos);
  write(session, replaced(proved, ",true", ",false"));
  CHECK(session.run(words(line + " --redo")).exit_code == 0);
  CHECK(session.read("table.csv") == proved);
}

TEST_CASE("redo: optima that did not converge are computed again, the others keep their bytes") {
  const Session session;
  const std::string line = "optimum disks8 --epsilon 0,0.5,1 --csv table.csv";
  REQUIRE(session.run(words(line)).exit_code == 0);
  const std::string proved = session.read("table.csv");
  const std::string kept = replaced(proved, ",interior,", ",eta_to_zero,");
  write(session, kept);
  CHECK(session.run(words(line + " --redo")).exit_code == 0);
  CHECK(session.read("table.csv") == kept);
  write(session, replaced(kept, ",eta_to_zero,", ",not_converged,"));
  CHECK(session.run(words(line + " --redo")).exit_code == 0);
  CHECK(session.read("table.csv") == proved);
  write(session, replaced(proved, ",interior,", ",not_converged,"));
  check_refused(session, "optimum disks8 --epsilon 0,0.5,1 --subdomains 3x1 --csv table.csv --redo",
                {"table.csv:2: subdomains: expected 3 of this work"});
  check_refused(session, "optimum disks8 --epsilon 0,0.5 --csv table.csv --redo", {"table.csv:4", "another"});
  check_refused(session, "optimum disks8 --epsilon 0,0.5,1 --redo", {"--redo", "--csv"});
}

TEST_CASE("redo: the tables of a study and their HDF5 file are repaired together") {
  const StudySession session;
  REQUIRE(session.run(words(study_line)).exit_code == 0);
  const std::string proved = session.rows(), tables = tables_text(session.read("out/study/study.h5"));
  session.spoil();
  const std::string links = session.read("out/study/links.csv");
  REQUIRE(tables_text(session.read("out/study/study.h5")) != tables);
  CHECK(session.run(words(study_line + " --redo")).exit_code == 0);
  CHECK(session.rows() == proved);
  CHECK(session.read("out/study/links.csv") == links);
  const std::string repaired = session.read("out/study/study.h5");
  CHECK(tables_text(repaired) == tables);
  const auto provenance = nscdd::tables_from_hdf5(repaired, "study.h5").provenance;
  CHECK(std::count(provenance.begin(), provenance.end(),
                   std::pair<std::string, std::string>{"redone", "nscdd " + study_line + " --redo\n"}) == 1);
  CHECK(content_of((session.folder / "out/study").string()).size() == 3);
  // Nothing is left to be done: nothing is written.
  CHECK(session.run(words(study_line + " --redo")).exit_code == 0);
  CHECK(session.read("out/study/study.h5") == repaired);
}

TEST_CASE("redo: a study of other points, an unfinished one and other options are refused") {
  const StudySession session;
  check_refused(session, study_line + " --redo", {"study.h5", "expected a complete result", "--resume"});
  REQUIRE(session.run(words(study_line)).exit_code == 0);
  check_refused(session, study_line + " --redo --force", {"--redo", "without --resume and --force"});
  session.file("out/study/radius.csv.record", "left by a run");
  check_refused(session, study_line + " --redo", {"radius.csv", "expected a complete result"});
  std::filesystem::remove(session.folder / "out/study/radius.csv.record");
  session.describe("0.1,2,inf");
  check_refused(session, study_line + " --redo", {"radius.csv:3: eta: expected 2 of this work, met 1"});
}

TEST_CASE("redo: an interrupted repair of a study leaves whole tables and an HDF5 file that agrees") {
  const StudySession session("1e-3:1e3:1500");
  REQUIRE(session.run(words(study_line)).exit_code == 0);
  const std::string proved = session.rows(), tables = tables_text(session.read("out/study/study.h5"));
  session.spoil();
  const std::string spoilt = tables_text(session.read("out/study/study.h5"));
  const RunOptions options{.signal_at = SignalAt{"radius.csv.partial", 2000, SIGTERM}};
  const Outcome outcome = session.run(words(study_line + " --redo"), options);
  CHECK(outcome.exit_code == 130);
  CHECK(outcome.standard_error.find("left as they were; --redo continues") != std::string::npos);
  const nscdd::CsvText part = nscdd::parse_csv(session.rows(), "radius.csv");
  REQUIRE(part.rows.size() == 6000);
  CHECK(part.rows.front().back() == "true");
  CHECK(part.rows.back().back() == "false");
  const std::string half = tables_text(session.read("out/study/study.h5"));
  CHECK(half != tables);
  CHECK(half != spoilt);
  CHECK(session.run(words(study_line + " --redo")).exit_code == 0);
  CHECK(session.rows() == proved);
  CHECK(tables_text(session.read("out/study/study.h5")) == tables);
}
