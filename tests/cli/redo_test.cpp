// SPDX-License-Identifier: GPL-3.0-or-later
// Rows that were not proved are computed again, and only they.
#include "session.hpp"

#include <doctest/doctest.h>

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
