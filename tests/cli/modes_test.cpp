// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd modes: tables and report, refusals, and the picture drawn from the tables.
#include "session.hpp"

#include <cmath>
#include <filesystem>

using namespace nscdd::testing;

TEST_CASE_FIXTURE(Session, "modes: the slowest mode of 4 disks has the radius of the sweep") {
  const std::string report = answer("modes disks4 --epsilon 0 --output slow");
  CHECK(content_of(folder.path()).size() == 2);  // no .partial either
  const CsvTable impulses = csv("slow-impulses.csv");
  const CsvTable velocities = csv("slow-velocities.csv");
  REQUIRE(impulses.rows.size() == 2);
  REQUIRE(velocities.rows.size() == 6);
  double share = 0;
  for (std::size_t row = 0; row < 2; ++row) {
    CHECK(std::abs(impulses.number(row, "eigenvalue") - (29 + std::sqrt(57.0)) / 56) < 1e-13);
    CHECK(impulses.text(row, "end") == "high");
    CHECK(impulses.number(row, "epsilon") == 0);
    CHECK(impulses.number(row, "eta") == INFINITY);
    CHECK(impulses.number(row, "subdomain_first") == 0);
    CHECK(impulses.number(row, "subdomain_second") == 1);
    share += impulses.number(row, "share");
    // P = 4 per gluing row of unit grains split in two, so the share is 4 |F_k|^2, and the jump - 4 lambda F_k
    const double fx = impulses.number(row, "impulse_x"), fy = impulses.number(row, "impulse_y");
    CHECK(std::abs(4 * (fx * fx + fy * fy) - impulses.number(row, "share")) < 1e-14);
    const double lambda = 1 - impulses.number(row, "eigenvalue");
    CHECK(std::abs(impulses.number(row, "jump_x") + 4 * lambda * fx) < 1e-13);
    CHECK(std::abs(impulses.number(row, "jump_y") + 4 * lambda * fy) < 1e-13);
  }
  CHECK(std::abs(share - 1) < 1e-14);
  CHECK(contains(report, "high end"));
  CHECK(contains(report, "0 | 1"));
  CHECK(contains(report, "100.00 %"));
}

TEST_CASE_FIXTURE(Session, "modes: both ends can be asked for, and equal commands give equal bytes") {
  for (const std::string& end : Texts{"low", "high"}) {
    const std::string line = "modes hexagonal --epsilon 0.1 --eta 0.01 --end " + end + " --output ";
    CHECK(answer(line + "a" + end) == answer(line + "b" + end));
    for (const std::string& table : Texts{"-impulses.csv", "-velocities.csv"})
      CHECK(read("a" + end + table) == read("b" + end + table));
    CHECK(read_table(read("a" + end + "-impulses.csv")).text(0, "end") == end);
  }
  answer("modes hexagonal --epsilon 0.1 --eta 0.01 --output slow");  // it diverges at the low end
  CHECK(read("slow-impulses.csv") == read("alow-impulses.csv"));
}

TEST_CASE_FIXTURE(Session, "modes: several eigenvalues of the end, certified") {
  const std::string report = answer("modes disks8 --epsilon 1 --eigenvalues 3 --certify --output a");
  const CsvTable swept = table("sweep disks8 --epsilon 1 --eigenvalues 3 --certify");
  for (const std::string& column : Texts{"eigenvalue_high_2", "eigenvalue_high_3"})
    CHECK(contains(report, "  next inwards       " + swept.text(0, column) + "\n"));
  CHECK(contains(report, "certified          1 eigenvalue(s) in [" + swept.text(0, "high_from")));
  // two copies of each of two grains: no fifth eigenvalue
  CHECK(contains(answer("modes disks8 --epsilon 1 --eigenvalues 5 --output b"), "not computed"));
}

TEST_CASE_FIXTURE(Session, "modes: B = 0 and a solver that fails are said, with tables that have no rows") {
  ended(0, "modes hexagonal --epsilon 0.3 --eta 0.3 --solver shift-invert --output a",
        {"every eigenvalue is the same"});
  CHECK(csv("a-impulses.csv").rows.empty());
  // dense: any vector is a mode, and it is said that there are others
  CHECK(contains(answer("modes hexagonal --epsilon 0.3 --eta 0.3 --solver dense --output b"), "one of several"));
  CHECK(!csv("b-impulses.csv").rows.empty());
}

TEST_CASE_FIXTURE(Session, "modes: usage that makes no sense") {
  file("mine.csv", row_of_three());
  check_refused("modes disks4 --output a", {"--epsilon"});
  check_refused("modes disks4 --epsilon 1", {"--output"});
  check_refused("modes disks4 --epsilon 1 --output a --end fastest", {"--end", "slowest", "fastest"});
  check_refused("modes disks4 --epsilon 0,1 --output a", {"--epsilon", "one number", "0,1"});
  check_refused("modes disks4 --epsilon 1 --eta 1:10:3 --output a", {"--eta", "one number"});
  check_refused("modes disks4 --epsilon -1 --output a", {"epsilon", ">= 0"});
  check_refused("modes disks4 --epsilon 1 --eta 0 --output a", {"eta", "> 0"});
  for (const std::string& prefix : Texts{"-", "folder/"})
    check_refused({"modes", "disks4", "--epsilon", "1", "--output", prefix}, {"--output", "prefix"});
  check_refused("modes disks4 --epsilon 1 --output nowhere/a", {"nowhere"});
  check_refused("modes disks4 --epsilon 1 --output a --eigenvalues 0", {"--eigenvalues", ">= 1"});
  check_refused("modes disks4 --epsilon 1 --output a --solver guess", {"--solver", "guess"});
  check_refused("modes mine.csv --epsilon 1 --contacts active --output a", {"prescribed"});
  check_refused("modes hexagonal --epsilon 1 --output a --memory-limit 1e-9", {"memory"});
}

TEST_CASE("modes: existing tables are refused, and replaced on demand") {
  for (const std::string& name : Texts{"a-impulses.csv", "a-velocities.csv"}) {
    const Session session;
    session.file(name, "precious");
    session.check_refused("modes disks4 --epsilon 1 --output a", {name, "exists already", "--force"});
    session.answer("modes disks4 --epsilon 1 --output a --force");
    CHECK(session.read(name).rfind("case,", 0) == 0);
  }
}

TEST_CASE("modes: a disk that fills up leaves nothing half-written") {
  for (const std::string& table : Texts{"-impulses.csv", "-velocities.csv"}) {
    const Session session;
    std::filesystem::create_symlink("/dev/full", session.folder / ("a" + table));
    session.check_refused("modes disks4 --epsilon 1 --output a", {"a" + table, "No space left"});
  }
}

TEST_CASE_FIXTURE(Session, "modes: an empty interface has none, said and tabled") {
  const Outcome outcome = ended(0, "modes disks4 --subdomains 1x1 --epsilon 1 --output a", {"the interface is empty"});
  CHECK(contains(outcome.standard_output, "empty interface"));
  CHECK(csv("a-impulses.csv").rows.empty());
  CHECK(csv("a-velocities.csv").rows.empty());
}
