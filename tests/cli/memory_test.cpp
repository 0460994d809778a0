// SPDX-License-Identifier: GPL-3.0-or-later
// Work that does not fit into memory is refused before it is done. The memory counted is that taken, with all threads.
#include "../support/thorough.hpp"
#include "session.hpp"

using namespace nscdd::testing;

namespace {

const std::string fcc =
    "[packing]\ngenerator = \"fcc\"\ncolumns = 12\nrows = 12\nlayers = 12\n[partition]\ngrid = [2, 2, 2]\n";

}  // namespace

TEST_CASE_FIXTURE(Session, "memory: a dense problem that does not fit is refused") {
  // 7 202 interface unknowns: six matrices of 0.39 GiB each
  check_refused(
      "sweep hexagonal --set packing.columns=60 --set packing.rows=60 --subdomains 30x30 --epsilon 1 "
      "--solver dense --csv a.csv --memory-limit 2",
      {"2 GiB", "--memory-limit", "interface unknowns", "arpack"});
}

TEST_CASE_FIXTURE(Session, "memory: a run is refused with 3/5 of what it takes, and done with 7/5") {
  file("fcc.toml", fcc);
  const std::string hexagonal = " hexagonal --set packing.columns=100 --set packing.rows=100 ";
  const std::string sweep = "sweep" + hexagonal + "--csv - --subdomains ", in_space = "sweep fcc.toml --csv - ";
  const std::string steps = " --steps 1 --iterations 3 --force -o run.h5 ";
  bool allow = true;  // every other one, where time is short
  for (const std::string& line : Texts{
           sweep + "16x1 --epsilon 1 --solver shift-invert", sweep + "16x1 --epsilon 1 --eta 0.1 --solver shift-invert",
           sweep + "16x1 --epsilon 0 --solver shift-invert", sweep + "30x30 --epsilon 1 --solver shift-invert",
           in_space + "--epsilon 1 --solver shift-invert", in_space + "--epsilon 1 --eta 0.1 --solver shift-invert",
           in_space + "--epsilon 1 --subdomains 4x4x4 --solver shift-invert",
           "sweep hexagonal --set packing.columns=60 --set packing.rows=60 --subdomains 8x8 "
           "--epsilon 1 --csv - --solver dense",
           "network --set loads.compression=1,1" + hexagonal,
           "network --contacts unilateral --set loads.compression=1,1" + hexagonal, "inspect --ranks" + hexagonal,
           "simulate settle-10k --algorithm newton" + steps,
           "simulate settle-10k --algorithm two_stage_newton --subdomains 2x1 --tolerance 1e-9" + steps,
           "simulate settle-10k --algorithm enriched --eta 30W" + steps}) {
    CAPTURE(line);
    const std::string limited = line + " --memory-limit ";
    const Outcome outcome = run(limited + "8");
    REQUIRE(outcome.exit_code == 0);
    const double taken = static_cast<double>(outcome.peak_memory) / (1 << 30);
    ended(2, limited + std::to_string(0.6 * taken), {"--memory-limit"});
    if (allow || thorough()) CHECK(run(limited + std::to_string(1.4 * taken)).exit_code == 0);
    allow = !allow;
  }
}

TEST_CASE_FIXTURE(Session, "memory: the limit of the user decides") {
  check_refused("sweep disks4 --epsilon 1 --csv - --memory-limit 1e-6", {"1e-06 GiB"});
  check_refused("optimum disks4 --memory-limit 1e-6", {"1e-06 GiB"});
  check_refused("run figure-6 --memory-limit 1e-6", {"1e-06 GiB"});
  check_refused("simulate shear-1k -o a.h5 --memory-limit 1e-6", {"1e-06 GiB"});
  check_refused("sweep disks4 --epsilon 1 --csv - --memory-limit 0", {"--memory-limit"});
  check_refused("network disks4 --memory-limit 0", {"--memory-limit"});
  answer("sweep disks4 --epsilon 1 --csv - --memory-limit 1");
}

TEST_CASE_FIXTURE(Session, "memory: what is not asked for needs no memory") {
  answer("inspect hexagonal --set packing.columns=300 --set packing.rows=300 --memory-limit 0.2");
  // 3 990 contacts of 40 000 grains, dense: a matrix of 2.4 GiB
  std::string row = "x,y,radius\n";
  for (int i = 0; i < 40000; ++i) row += std::to_string(i < 3991 ? 2 * i : 3 * i) + ",0,1\n";
  file("row.csv", row);
  check_refused("network row.csv --memory-limit 2 --prescribed 0:1:0", {"impulses of 3990 contacts"});
  CHECK(run("network row.csv --memory-limit 2 --csv links.csv").exit_code == 0);  // no impulses
}
