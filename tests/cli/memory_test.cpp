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
