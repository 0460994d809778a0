// SPDX-License-Identifier: GPL-3.0-or-later
// Work that does not fit into memory is refused before it begins.
#include "session.hpp"

#include <doctest/doctest.h>

using namespace nscdd::testing;

TEST_CASE("memory: a dense problem that does not fit is refused at once") {
  const Session session;
  // 72 002 interface unknowns: one matrix of 39 GiB
  const std::string line =
      "sweep hexagonal --set packing.columns=180 --set packing.rows=180 --subdomains 90x90 --epsilon 1 "
      "--solver dense --csv a.csv --memory-limit 30";
  check_refused(session, line, {"30 GiB", "--memory-limit", "72002 interface unknowns", "arpack"});
}

TEST_CASE("memory: what the rigid limit takes is within its estimate, and no tenth of it") {
  const Session session;
  const std::string line =
      "sweep hexagonal --set packing.columns=100 --set packing.rows=100 --subdomains 16x1 --epsilon 0 "
      "--eta inf --solver shift-invert --csv - --memory-limit ";
  const Outcome outcome = session.run(words(line + "4"));
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.standard_output.find("true") != std::string::npos);
  const double taken = static_cast<double>(outcome.peak_memory) / (1 << 30);
  check_refused(session, line + std::to_string(taken), {"--memory-limit"});
  CHECK(session.run(words(line + std::to_string(10 * taken))).exit_code == 0);
}

TEST_CASE("memory: where copies of grains abound the estimate is no less than what is taken, and not far more") {
  const Session session;
  for (const std::string parts : {"40x40", "20x20"}) {
    CAPTURE(parts);
    const std::string line = "sweep hexagonal --set packing.columns=45 --set packing.rows=45 --subdomains " + parts +
                             " --epsilon 1 --solver shift-invert --csv - --memory-limit ";
    const Outcome outcome = session.run(words(line + "4"));
    REQUIRE(outcome.exit_code == 0);
    const double taken = static_cast<double>(outcome.peak_memory) / (1 << 30);
    check_refused(session, line + std::to_string(taken), {"--memory-limit"});
    CHECK(session.run(words(line + std::to_string(2.5 * taken))).exit_code == 0);
  }
}

TEST_CASE("memory: spectra in space take no more than the estimate, and no tenth of it") {
  const Session session;
  session.file("fcc.toml", case_text("fcc\ncolumns = 12\nrows = 12\nlayers = 12", "2, 2, 2"));
  for (const std::string point : {"--epsilon 1 --eta inf", "--epsilon 1 --eta 0.1", "--epsilon 0 --eta inf",
                                  "--epsilon 1 --eta inf --subdomains 4x4x4"}) {
    CAPTURE(point);
    const std::string line = "sweep fcc.toml " + point + " --solver shift-invert --csv - --memory-limit ";
    const Outcome outcome = session.run(words(line + "8"));
    REQUIRE(outcome.exit_code == 0);
    CHECK(outcome.standard_output.find("true") != std::string::npos);
    const double taken = static_cast<double>(outcome.peak_memory) / (1 << 30);
    check_refused(session, line + std::to_string(taken), {"--memory-limit"});
    CHECK(session.run(words(line + std::to_string(10 * taken))).exit_code == 0);
  }
}

TEST_CASE("memory: ranks in space take no more than the estimate, and no tenth of it") {
  const Session session;
  session.file("fcc.toml", case_text("fcc\ncolumns = 14\nrows = 14\nlayers = 14", "2, 2, 2"));
  const std::string line = "inspect fcc.toml --memory-limit ";
  const Outcome outcome = session.run(words(line + "8"));
  REQUIRE(outcome.exit_code == 0);
  const double taken = static_cast<double>(outcome.peak_memory) / (1 << 30);
  check_refused(session, line + std::to_string(taken), {"--memory-limit"});
  CHECK(session.run(words(line + std::to_string(10 * taken))).exit_code == 0);
}

TEST_CASE("memory: the limit of the user decides") {
  const Session session;
  check_refused(session, "sweep disks4 --epsilon 1 --csv - --memory-limit 1e-6", {"1e-06 GiB"});
  check_refused(session, "optimum disks4 --memory-limit 1e-6", {"1e-06 GiB"});
  check_refused(session, "sweep disks4 --epsilon 1 --csv - --memory-limit 0", {"--memory-limit"});
  answer(session, "sweep disks4 --epsilon 1 --csv - --memory-limit 1");
  const Outcome outcome = session.run(words("run figure-6 --memory-limit 1e-6"));
  CHECK(outcome.exit_code == 2);
  CHECK(outcome.standard_error.find("case disks") != std::string::npos);
}

TEST_CASE("memory: impulses of contacts and ranks that do not fit are refused at once") {
  const Session session;
  const std::string lattice = "hexagonal --set packing.columns=100 --set packing.rows=100 --memory-limit ";
  const std::string loaded = " --set loads.compression=1,1";
  for (const std::string contacts : {"active", "unilateral"})
    check_refused(session, "network " + lattice + "0.05 --contacts " + contacts + loaded + " --grains g.csv",
                  {"0.05 GiB", "--memory-limit", "impulses of 29601 contacts", "fewer grains"});
  check_refused(session, "inspect " + lattice + "0.05 --ranks --histogram h.csv",
                {"0.05 GiB", "--memory-limit", "ranks of 29601 contacts", "--ranks"});
  answer(session, "inspect hexagonal --set packing.columns=300 --set packing.rows=300 --memory-limit 0.2");
  // 3 990 contacts of 40 000 grains, dense: a matrix of 2.4 GiB
  std::string row = "x,y,radius\n";
  for (int i = 0; i < 40000; ++i) row += std::to_string(i < 3991 ? 2 * i : 3 * i) + ",0,1\n";
  session.file("row.csv", row);
  check_refused(session, "network row.csv --memory-limit 2 --prescribed 0:1:0", {"impulses of"});
  CHECK(session.run(words("network row.csv --memory-limit 2 --csv links.csv")).exit_code == 0);  // no impulses
  check_refused(session, "network disks4 --memory-limit 0", {"--memory-limit"});
}

TEST_CASE("memory: what impulses and ranks take is within the estimate, and no tenth of it") {
  const Session session;
  const std::string lattice = "hexagonal --set packing.columns=100 --set packing.rows=100 --memory-limit ";
  for (const std::string verb : {"inspect --ranks ", "network --set loads.compression=1,1 ",
                                 "network --contacts unilateral --set loads.compression=1,1 "}) {
    CAPTURE(verb);
    const std::string line = verb + lattice;
    const Outcome outcome = session.run(words(line + "4"));
    REQUIRE(outcome.exit_code == 0);
    const double taken = static_cast<double>(outcome.peak_memory) / (1 << 30);
    check_refused(session, line + std::to_string(taken), {"--memory-limit"});
    CHECK(session.run(words(line + std::to_string(10 * taken))).exit_code == 0);
  }
}
