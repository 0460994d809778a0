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
