// SPDX-License-Identifier: GPL-3.0-or-later
// Unusual and legal: few grains, no contacts, empty subdomains, an empty interface. All of it is reported.
#include "session.hpp"

#include <cmath>

using namespace nscdd::testing;

namespace {

// A sweep whose interface is empty: legal, said on standard error, radius 0 in every row.
void check_nothing_to_contract(const Session& session, const std::string& packing, const std::string& options) {
  const std::string line = "sweep " + packing + " --epsilon 0,1 --eta 0.3,inf --csv - " + options;
  CAPTURE(line);
  const Outcome outcome = session.ended(0, line, {"interface is empty"});
  const CsvTable result = read_table(outcome.standard_output);
  REQUIRE(result.rows.size() == 4);
  for (std::size_t row = 0; row < 4; ++row) {
    CHECK(result.number(row, "interface_dofs") == 0);
    CHECK(result.number(row, "spectral_radius") == 0);
    CHECK(result.text(row, "solver") == "none");
    CHECK(result.text(row, "converged") == "true");
  }
}

// An optimum without an interface is a row with that status, and a note says why.
void check_nothing_to_optimise(const Session& session, const std::string& arguments) {
  const Outcome outcome = session.ended(0, "optimum " + arguments + " --csv -", {"the interface is empty"});
  CHECK(read_table(outcome.standard_output).text(0, "status") == "no_interface");
}

}  // namespace

TEST_CASE_FIXTURE(Session, "legal: one grain") {
  file("one.csv", "x,y,radius\n0,0,0.5\n");
  check_nothing_to_contract(*this, "one.csv", "");
  check_nothing_to_contract(*this, "one.csv", "--subdomains 3x2");
  check_nothing_to_contract(*this, "one.csv", "--subdomains metis:2");
  CHECK(contains(answer("inspect one.csv"), "touching nothing   1"));
  check_nothing_to_optimise(*this, "one.csv --contacts all");
  const Outcome network = ended(0, "network one.csv --grains grains.csv");
  CHECK(read_table(network.standard_output).rows.empty());
  CHECK(csv("grains.csv").rows.size() == 1);
}

TEST_CASE_FIXTURE(Session, "legal: no contacts") {
  file("apart.csv", "x,y,radius\n0,0,0.5\n5,0,0.5\n0,5,0.25\n");
  check_nothing_to_contract(*this, "apart.csv", "");
  check_nothing_to_contract(*this, "apart.csv", "--subdomains 2x2");
  check_nothing_to_contract(*this, "apart.csv", "--subdomains metis:3");
  const std::string report = answer("inspect apart.csv --subdomains 2x2");
  CHECK(contains(report, "touching nothing   3"));
  CHECK(contains(report, "4 (4 without a contact)"));
  CHECK(contains(report, "empty interface"));
}

TEST_CASE_FIXTURE(Session, "legal: grains that touch nothing") {
  file("four.csv", row_of_three());
  file("three.csv", replaced(row_of_three(), "9,9,0.5\n", ""));
  CHECK(contains(answer("inspect four.csv --subdomains metis:2"), "touching nothing   1"));
  // the METIS partition knows contacts only, so the grain apart changes nothing
  const std::string options = " --subdomains metis:2 --epsilon 0,1 --eta 0.3,inf";
  const CsvTable with = table("sweep four.csv" + options);
  const CsvTable without = table("sweep three.csv" + options);
  REQUIRE(with.rows.size() == 4);
  for (std::size_t row = 0; row < 4; ++row)
    CHECK(with.text(row, "spectral_radius") == without.text(row, "spectral_radius"));
  answer("network four.csv --prescribed 0:1:0 --grains grains.csv --csv links.csv");
  CHECK(csv("grains.csv").text(3, "multiplicity") == "0");
}

TEST_CASE_FIXTURE(Session, "legal: subdomains without a contact") {
  file("row.csv", "x,y,radius\n0,0,0.5\n1,0,0.5\n2,0,0.5\n");
  // midpoints at 0.5 and 1.5 of [0, 2]: columns 0 and 7 of ten have a contact each
  const CsvTable result = table("sweep row.csv --subdomains 10x3 --epsilon 0,1 --eta 0.3,inf");
  const CsvTable two = table("sweep row.csv --subdomains 2x1 --epsilon 0,1 --eta 0.3,inf");
  REQUIRE(result.rows.size() == 4);
  for (std::size_t row = 0; row < 4; ++row) {
    CHECK(result.number(row, "subdomains") == 30);
    CHECK(std::abs(result.number(row, "spectral_radius") - two.number(row, "spectral_radius")) < 1e-14);
  }
  CHECK(contains(answer("inspect row.csv --subdomains 10x3"), "30 (28 without a contact)"));
  CHECK(table("sweep row.csv --subdomains 10x3 --epsilon 1 --gauss-seidel-sweeps 1,2").rows.size() == 2);
  CHECK(table("optimum row.csv --subdomains 10x3 --contacts all --epsilon 1").rows.size() == 1);
}

TEST_CASE_FIXTURE(Session, "legal: one subdomain only") {
  file("row.csv", row_of_three());
  check_nothing_to_contract(*this, "row.csv", "");
  check_nothing_to_contract(*this, "disks12", "--subdomains 1x1");
  check_nothing_to_contract(*this, "disks12", "--subdomains 1x1 --contacts active");
  check_nothing_to_contract(*this, "disks12", "--subdomains metis:1");
  check_nothing_to_contract(*this, "disks12", "--subdomains 1x1 --solver arpack");
  CHECK(contains(answer("inspect disks12 --subdomains 1x1"), "empty interface"));
  check_nothing_to_optimise(*this, "disks12 --subdomains 1x1");
}

TEST_CASE_FIXTURE(Session, "legal: more METIS parts than contacts") {
  const Outcome outcome = run("sweep disks4 --subdomains metis:9 --epsilon 0,1 --csv -");
  CHECK(contains(outcome.standard_error, "disks4: 5 contacts cannot fill 9 subdomains: 4 of these are empty"));
  const CsvTable result = read_table(outcome.standard_output);
  CHECK(result.number(0, "subdomains") == 9);
  CHECK(result.text(1, "converged") == "true");
}

TEST_CASE_FIXTURE(Session, "legal: two grains and one contact, and subdomains that share no grain") {
  file("pairs.csv", "x,y,radius\n0,0,0.5\n1,0,0.5\n10,0,0.5\n11,0,0.5\n");
  check_nothing_to_contract(*this, "pairs.csv", "--subdomains 2x1");
  file("two.csv", "x,y,radius,mass\n0,0,1,1\n3,0,2,5\n");
  check_nothing_to_contract(*this, "two.csv", "");
  check_nothing_to_contract(*this, "two.csv", "--subdomains 2x1");
}

TEST_CASE_FIXTURE(Session, "legal: epsilon and eta at the ends of what a number holds") {
  const CsvTable result = table("sweep disks4 --epsilon 1e-300,1e300 --eta 1e-300,1e300");
  REQUIRE(result.rows.size() == 4);
  for (std::size_t row = 0; row < 4; ++row) CHECK(std::isfinite(result.number(row, "spectral_radius")));
  CHECK(std::abs(result.number(1, "spectral_radius") - (29 + std::sqrt(57.0)) / 56) < 1e-12);
}

TEST_CASE_FIXTURE(Session, "legal: masses of very different size") {
  file("uneven.csv", "x,y,radius,mass\n0,0,0.5,1\n1,0,0.5,1e12\n2,0,0.5,1e-12\n3,0,0.5,1\n");
  const CsvTable result = table("sweep uneven.csv --subdomains 2x1 --epsilon 0,1 --eta 1,inf");
  for (std::size_t row = 0; row < result.rows.size(); ++row) {
    CHECK(result.text(row, "converged") == "true");
    CHECK(std::isfinite(result.number(row, "spectral_radius")));
  }
}

TEST_CASE_FIXTURE(Session, "legal: a rigid hyperstatic limit reports its unit eigenvalues") {
  const CsvTable result = table("sweep hexagonal --epsilon 0 --solver dense");
  CHECK(result.number(0, "unit_multiplicity") > 0);
  CHECK(std::abs(result.number(0, "spectral_radius") - 1) < 1e-12);
  CHECK(result.number(0, "subdominant_radius") < 1);
  CHECK(contains(answer("inspect hexagonal"), "unit eigenvalues of B_0  " + result.text(0, "unit_multiplicity")));
}
