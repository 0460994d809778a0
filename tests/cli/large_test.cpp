// SPDX-License-Identifier: GPL-3.0-or-later
// Large packings from the command line: memory, threads, certificates, several eigenvalues.
#include "session.hpp"

#include <algorithm>
#include <cmath>

using namespace nscdd::testing;

namespace {

// A surface density of 4/pi makes disks of unit diameter 1 kg each.
const std::string lattice = "hexagonal --set masses.density=1.2732395447351628 --set packing.columns=";

}  // namespace

TEST_CASE_FIXTURE(Session, "large: 10^5 grains in 16 strips within 1 GiB") {
  const Outcome outcome =
      ended(0, "sweep " + lattice + "400 --set packing.rows=250 --subdomains 16x1 --epsilon 1 --csv - --threads 2");
  CHECK(outcome.standard_error == "");
  CHECK(outcome.peak_memory < std::size_t{1} << 30);
  CHECK(outcome.peak_memory > std::size_t{1} << 28);  // or it was not measured
  const CsvTable result = read_table(outcome.standard_output);
  REQUIRE(result.rows.size() == 1);
  CHECK(result.number(0, "grains") == 100000);
  CHECK(result.number(0, "interface_dofs") == 7500);
  CHECK(result.text(0, "solver") == "shift-invert");
  CHECK(result.text(0, "converged") == "true");
  CHECK(result.number(0, "residual") <= 1e-8);
}

TEST_CASE_FIXTURE(Session, "large: a sweep is the same bytes for any number of threads, certificates included") {
  const std::string line = "sweep " + lattice +
                           "60 --set packing.rows=50 --subdomains 5x3 --epsilon 1e-2:1:3 --eta 0.5,inf --csv - "
                           "--solver shift-invert --certify --eigenvalues 2 --threads ";
  const std::string one = run(line + "1").standard_output;
  CHECK(read_table(one).rows.size() == 6);
  for (const std::string threads : {"2", "3", "4", "0"}) CHECK(run(line + threads).standard_output == one);
}

TEST_CASE_FIXTURE(Session, "certify: its columns come last, and hold the ends of the dense solver") {
  const std::string line =
      "sweep " + lattice + "12 --set packing.rows=10 --subdomains 4x2 --epsilon 1e-3,0.1,5 --eta 0.3,inf --solver ";
  const CsvTable dense = table(line + "dense"), plain = table(line + "shift-invert"),
                 certified = table(line + "shift-invert --certify");
  Texts expected = plain.columns;
  for (const char* name :
       {"certified", "low_from", "low_to", "high_from", "high_to", "low_multiplicity", "high_multiplicity"})
    expected.emplace_back(name);
  CHECK(certified.columns == expected);
  REQUIRE(certified.rows.size() == 6);
  for (std::size_t row = 0; row < 6; ++row) {
    CAPTURE(row);
    CHECK(certified.text(row, "certified") == "true");
    CHECK(certified.text(row, "solver") == "shift-invert");
    const double low = dense.number(row, "eigenvalue_min"), high = dense.number(row, "eigenvalue_max");
    const double slack = 1e-11 * std::max(1.0, std::abs(low));
    CHECK(certified.number(row, "low_from") <= low + slack);
    CHECK(certified.number(row, "low_to") >= low - slack);
    CHECK(certified.number(row, "high_from") <= high + slack);
    CHECK(certified.number(row, "high_to") >= high - slack);
    CHECK(certified.number(row, "low_multiplicity") >= 1);
    CHECK(certified.number(row, "high_multiplicity") >= 1);
    CHECK(certified.text(row, "spectral_radius") == plain.text(row, "spectral_radius"));
  }
}

TEST_CASE_FIXTURE(Session, "eigenvalues: as many columns as asked for, from each end inwards") {
  const CsvTable result = table("sweep disks8 --epsilon 1,0.1 --eta inf --eigenvalues 3");
  Texts names = table("sweep disks8 --epsilon 1").columns;
  for (const char* name : {"low_multiplicity", "high_multiplicity", "eigenvalue_low_1", "eigenvalue_low_2",
                           "eigenvalue_low_3", "eigenvalue_high_1", "eigenvalue_high_2", "eigenvalue_high_3"})
    names.emplace_back(name);
  CHECK(result.columns == names);
  for (std::size_t row = 0; row < 2; ++row) {
    CHECK(result.text(row, "eigenvalue_low_1") == result.text(row, "eigenvalue_min"));
    CHECK(result.text(row, "eigenvalue_high_1") == result.text(row, "eigenvalue_max"));
    CHECK(result.number(row, "eigenvalue_low_1") <= result.number(row, "eigenvalue_low_2"));
    CHECK(result.number(row, "eigenvalue_high_1") >= result.number(row, "eigenvalue_high_2"));
    // 4 interface unknowns: the second from below is the third from above
    CHECK(std::abs(result.number(row, "eigenvalue_low_2") - result.number(row, "eigenvalue_high_3")) < 1e-13);
  }
  // More than there are: the rest is nan.
  const CsvTable more = table("sweep disks8 --epsilon 1 --eigenvalues 6");
  CHECK(std::isfinite(more.number(0, "eigenvalue_low_4")));
  CHECK(std::isnan(more.number(0, "eigenvalue_low_5")));
  CHECK(std::isnan(more.number(0, "eigenvalue_high_6")));
}

TEST_CASE_FIXTURE(Session, "certify, eigenvalues, threads: wrong values are refused") {
  const std::string line = "sweep disks4 --epsilon 1 --csv a.csv ";
  for (const std::string wrong : {"0", "-1", "101", "2.5", "many", "nan"})
    check_refused(line + "--eigenvalues " + wrong, {"--eigenvalues", wrong});
  for (const std::string wrong : {"-1", "4097", "1.5", "all"})
    check_refused(line + "--threads " + wrong, {"--threads", wrong});
  check_refused(line + "--certify=perhaps", {"--certify", "perhaps"});
  check_refused(line + "--solver shift_invert", {"--solver", "shift-invert"});
}

TEST_CASE_FIXTURE(Session, "certify: a table written to a file is the same bytes each time") {
  const std::string line = "sweep " + lattice +
                           "12 --set packing.rows=10 --subdomains 4x2 --epsilon 1e-2:1:11 --solver shift-invert "
                           "--certify --csv ";
  answer(line + "whole.csv");
  CHECK(csv("whole.csv").rows.size() == 11);
  answer(line + "again.csv --threads 2");
  CHECK(read("again.csv") == read("whole.csv"));
}
