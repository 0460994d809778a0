// SPDX-License-Identifier: GPL-3.0-or-later
// Rows that were not proved are computed again, and only they.
#include "session.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <fstream>

using namespace nscdd::testing;

namespace {

const std::string sweep_line = "sweep disks8 --epsilon 1e-2,1,10 --eta 0.3,inf --csv table.csv";

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
  CHECK(session.run(words(sweep_line + " --redo")).exit_code == 0);
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
  RunOptions options;
  options.kill_signal = SIGINT;
  options.kill_when = [&] {
    return session.has("table.csv.partial") && session.read("table.csv.partial").size() > 2000;
  };
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
