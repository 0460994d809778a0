// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd sweep: columns, rows, known radii, the forms of a SPEC.
#include "session.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace nscdd::testing;

namespace {

// Largest eigenvalue of B_eps for 4 disks: the larger root of
// (4 e^3 + 44 e^2 + 153 e + 168) z^2 - (16 e^2 + 108 e + 174) z + 15 e + 42 = 0, or 3/(5 + 2 e).
double four_disks(double e) {
  const double a = 4 * e * e * e + 44 * e * e + 153 * e + 168, b = 16 * e * e + 108 * e + 174;
  return std::max((b + std::sqrt(b * b - 4 * a * (15 * e + 42))) / (2 * a), 3 / (5 + 2 * e));
}

std::vector<double> column(const CsvTable& table, const std::string& name) {
  std::vector<double> values;
  for (std::size_t row = 0; row < table.rows.size(); ++row) values.push_back(table.number(row, name));
  return values;
}

std::vector<double> epsilons(const Session& session, const std::string& spec) {
  return column(session.table("sweep disks4 --epsilon " + spec), "epsilon");
}

}  // namespace

TEST_CASE_FIXTURE(Session, "sweep: the columns of the table have their names") {
  const CsvTable result = table("sweep disks4 --epsilon 1");
  for (const std::string& name :
       Texts{"case", "grains", "contacts", "subdomains", "interface_dofs", "contact_set", "epsilon", "eta",
             "spectral_radius", "eigenvalue_min", "eigenvalue_max", "unit_multiplicity", "subdominant_radius", "solver",
             "applications", "residual", "converged"}) {
    CAPTURE(name);
    CHECK(std::count(result.columns.begin(), result.columns.end(), name) == 1);
  }
  REQUIRE(result.rows.size() == 1);
  CHECK(result.text(0, "case") == "disks4");
  CHECK(result.number(0, "grains") == 4);
  CHECK(result.number(0, "contacts") == 5);
  CHECK(result.number(0, "subdomains") == 2);
  CHECK(result.number(0, "interface_dofs") == 4);
  CHECK(result.text(0, "contact_set") == "all");
  CHECK(result.number(0, "eta") == INFINITY);
  CHECK(result.text(0, "solver") == "dense");
  CHECK(result.text(0, "converged") == "true");
}

// Every row is a chain of disks of unit mass that is cut in its middle grain, see degenerate_spectra_test.cpp.
TEST_CASE_FIXTURE(Session, "sweep: a search for several eigenvalues next to the rigid limit comes to an end") {
  run("sweep hexagonal --subdomains 4x4 --epsilon 1e-12W --eigenvalues 2 --solver shift-invert --csv o.csv");
  CHECK(csv("o.csv").rows.size() == 1);
}

TEST_CASE_FIXTURE(Session,
                  "optimum: a radius within its residual is none, and a failure is one of the relaxed search too") {
  const std::string line = "optimum hexagonal --subdomains 4x4 --contacts all --solver shift-invert --csv - --epsilon ";
  for (const std::string soft : {"1e9", "1e10"}) {
    const CsvTable table = read_table(answer(line + soft));
    CHECK(table.text(0, "status") == "already_exact");
    CHECK(table.text(0, "relaxed_status") == "already_exact");
  }
  const CsvTable failed = read_table(run(line + "1e-13W").standard_output);
  CHECK(failed.text(0, "status") == "not_converged");
  CHECK(failed.text(0, "relaxed_status") == "not_converged");
}

TEST_CASE_FIXTURE(Session, "sweep: an error keeps the rows before it for --resume") {
  file("study/c.toml", "[packing]\ngenerator = \"hexagonal\"\n[partition]\ngrid = [2, 1]\n");
  file("study/study.toml",
       "[[table]]\nname = \"a\"\ncases = [\"c.toml\"]\nvary = { \"packing.columns\" = [4, 5, 100000] }\n");
  ended(2, "run study --memory-limit 0.2", {"memory-limit"});
  CHECK(csv("results/study/a.csv.partial").rows.size() == 2);
  check_refused("run study", {"a.csv.partial", "--resume continues it"});
}

TEST_CASE_FIXTURE(Session, "many equal eigenvalues: every verb has the radius and the mode of a square lattice") {
  for (const int rows : {1, 8, 20, 31}) {
    CAPTURE(rows);
    std::string packing = "x,y,radius\n";
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < 5; ++i) packing += std::to_string(i) + "," + std::to_string(j) + ",0.5\n";
    file("square.csv", packing);
    const std::string what = " square.csv --subdomains 2x1 --epsilon 1 ";
    for (const char* options : {"", "--solver dense", "--solver shift-invert --certify --eigenvalues 3",
                                "--solver arpack", "--certify --eigenvalues 7"}) {
      CAPTURE(options);
      const CsvTable found = table("sweep" + what + options);
      CHECK(found.text(0, "converged") == "true");
      CHECK(found.number(0, "spectral_radius") == doctest::Approx(6.0 / 11).epsilon(1e-8));
    }
    const CsvTable best = table("optimum" + what + "--contacts all");
    CHECK(best.number(0, "generic_radius") == doctest::Approx(6.0 / 11).epsilon(1e-8));
    CHECK(best.text(0, "status") != "not_converged");
    const Outcome mode = ended(0, "modes" + what + "--force --output slow");
    CHECK(contains(mode.standard_output, "0.545454545"));
    CHECK(!contains(mode.standard_error, "there is no mode"));
  }
}

TEST_CASE_FIXTURE(Session, "a row that stays open says which solvers were tried, and why each failed") {
  const Outcome outcome = ended(0, "sweep hexagonal --epsilon 1 --eta 1e-13,1 --solver shift-invert --csv -");
  const CsvTable rows = read_table(outcome.standard_output);
  CHECK(rows.text(0, "converged") == "false");
  CHECK(rows.text(0, "solver").starts_with("shift-invert: "));
  CHECK(contains(outcome.standard_error, "eta = 1e-13: not converged: shift-invert: "));
  CHECK(contains(outcome.standard_error, "1 row(s) did not converge"));
  CHECK(rows.text(1, "solver") == "shift-invert");
}

TEST_CASE_FIXTURE(Session, "sweep: one row per epsilon and eta in the order given") {
  const CsvTable result = table("sweep disks8 --epsilon 0,1,0.5 --eta 0.3,inf");
  CHECK(column(result, "epsilon") == std::vector<double>{0, 0, 1, 1, 0.5, 0.5});
  CHECK(column(result, "eta") == std::vector<double>{0.3, INFINITY, 0.3, INFINITY, 0.3, INFINITY});
}

TEST_CASE_FIXTURE(Session, "sweep: closed form of 4 disks") {
  const CsvTable result = table("sweep disks4 --epsilon 0,1e-6:1e6:49");
  REQUIRE(result.rows.size() == 50);
  CHECK(std::abs(result.number(0, "spectral_radius") - (29 + std::sqrt(57.0)) / 56) < 1e-14);
  for (std::size_t row = 0; row < result.rows.size(); ++row) {
    CAPTURE(row);
    CHECK(std::abs(result.number(row, "spectral_radius") - four_disks(result.number(row, "epsilon"))) < 1e-12);
    CHECK(result.number(row, "eigenvalue_max") == result.number(row, "spectral_radius"));
    CHECK(result.number(row, "residual") < 1e-12);
  }
}

TEST_CASE_FIXTURE(Session, "sweep: active contacts of 4 disks give 3/5, and eta = epsilon 0") {
  const CsvTable result = table("sweep disks4 --epsilon 0 --eta inf,0.1 --contacts active");
  REQUIRE(result.rows.size() == 2);
  CHECK(result.text(0, "contact_set") == "active");
  CHECK(std::abs(result.number(0, "spectral_radius") - 0.6) < 1e-14);
  CHECK(result.number(1, "spectral_radius") > 1);  // a radius above 1 is a result like another
  CHECK(result.text(1, "converged") == "true");
  // eta = epsilon converges at once
  CHECK(table("sweep disks12 --epsilon 0.7 --eta 0.7").number(0, "spectral_radius") < 1e-12);
}

TEST_CASE_FIXTURE(Session, "sweep: dense and arpack agree") {
  const std::string line = "sweep hexagonal --epsilon 0.01,1 --eta 0.3,inf --solver ";
  const CsvTable dense = table(line + "dense"), arpack = table(line + "arpack");
  REQUIRE(dense.rows.size() == 4);
  REQUIRE(arpack.rows.size() == 4);
  for (std::size_t row = 0; row < 4; ++row) {
    CHECK(dense.text(row, "solver") == "dense");
    CHECK(arpack.text(row, "solver") == "arpack");
    CHECK(arpack.number(row, "applications") > 0);
    CHECK(std::abs(dense.number(row, "spectral_radius") - arpack.number(row, "spectral_radius")) < 1e-9);
  }
}

TEST_CASE_FIXTURE(Session, "sweep: relaxation and Gauss-Seidel sweeps add rows") {
  const CsvTable relaxed = table("sweep disks4 --epsilon 0 --eta 1e-3 --contacts active --relaxation 1,optimal");
  REQUIRE(relaxed.rows.size() == 2);
  CHECK(relaxed.number(0, "spectral_radius") > 1);
  CHECK(relaxed.number(1, "spectral_radius") < 1);
  const CsvTable inexact = table("sweep disks4 --epsilon 1 --gauss-seidel-sweeps 1,200,inf");
  CHECK(column(inexact, "gauss_seidel_sweeps") == std::vector<double>{1, 200, INFINITY});
  CHECK(std::abs(inexact.number(1, "spectral_radius") - inexact.number(2, "spectral_radius")) < 1e-9);
}

TEST_CASE_FIXTURE(Session, "SPEC: a number, lists, ranges within them, and a range whose ends are equal") {
  CHECK(epsilons(*this, "0.25") == std::vector<double>{0.25});
  CHECK(epsilons(*this, "1e-3,+2,0") == std::vector<double>{1e-3, 2, 0});
  CHECK(epsilons(*this, "0,1:100:3,5") == std::vector<double>{0, 1, 10, 100, 5});
  CHECK(epsilons(*this, "8:8:4") == std::vector<double>{8, 8, 8, 8});
  CHECK(epsilons(*this, "8:8:1") == std::vector<double>{8});
}

TEST_CASE_FIXTURE(Session, "SPEC: FROM:TO:COUNT is logarithmic with exact ends") {
  const std::vector<double> values = epsilons(*this, "1e-3:7e2:6");
  REQUIRE(values.size() == 6);
  CHECK(values.front() == 1e-3);
  CHECK(values.back() == 7e2);
  for (std::size_t i = 1; i < values.size(); ++i)
    CHECK(values[i] / values[i - 1] == doctest::Approx(std::pow(7e5, 0.2)).epsilon(1e-12));
}

TEST_CASE_FIXTURE(Session, "SPEC: FROM:TO:COUNT:linear has equal steps with exact ends") {
  const std::vector<double> values = epsilons(*this, "0:0.3:4:linear");
  REQUIRE(values.size() == 4);
  CHECK(values.front() == 0);
  CHECK(values.back() == 0.3);
  CHECK(values[1] == doctest::Approx(0.1).epsilon(1e-14));
  CHECK(epsilons(*this, "2:1:3:linear") == std::vector<double>{2, 1.5, 1});
}

TEST_CASE_FIXTURE(Session, "a packing file with subdomains given on the command line") {
  file("mine.csv",
       "x,y,radius\n0,0,0.5\n0.5,0.8660254037844386,0.5\n1,0,0.5\n"
       "1.5,0.8660254037844386,0.5\n");
  const CsvTable mine = table("sweep mine.csv --subdomains 2x1 --epsilon 1e-3,1 --eta 0.3,inf");
  const CsvTable known = table("sweep disks4 --epsilon 1e-3,1 --eta 0.3,inf");
  REQUIRE(mine.rows.size() == 4);
  CHECK(mine.text(0, "case") == "mine");
  for (std::size_t row = 0; row < 4; ++row)
    CHECK(std::abs(mine.number(row, "spectral_radius") - known.number(row, "spectral_radius")) < 1e-12);
}

TEST_CASE_FIXTURE(Session, "options for a packing file: prescribed velocity and density and METIS") {
  file("mine.csv", row_of_three());
  const std::string line = "sweep mine.csv --subdomains metis:2 --epsilon 1 ";
  CHECK(table(line).number(0, "subdomains") == 2);
  const CsvTable active = table(line + "--prescribed 2:-1:0 --contacts active");
  CHECK(active.number(0, "contacts") == 2);
  CHECK(active.number(0, "active_contacts") == 2);
  CHECK(active.text(0, "contact_set") == "active");
  // -1 is the last grain, which touches nothing here, and -2 the one before
  CHECK(table(line + "--prescribed -2:-1:0 --contacts active").rows == active.rows);
  // masses k times as large are what a flexibility k times as large is for unit masses
  const double mass = 2 * std::numbers::pi * 0.25;
  const double heavy = table(line + "--density 2").number(0, "spectral_radius");
  const std::string scaled = "sweep mine.csv --subdomains metis:2 --epsilon " + std::to_string(mass);
  CHECK(std::abs(heavy - table(scaled).number(0, "spectral_radius")) < 1e-6);
}

TEST_CASE_FIXTURE(Session, "a parameter of the case set from the command line") {
  const CsvTable result = table("sweep strip --set packing.grains=8 --epsilon 1");
  CHECK(result.number(0, "grains") == 8);
  CHECK(std::abs(result.number(0, "spectral_radius") - table("sweep disks8 --epsilon 1").number(0, "spectral_radius")) <
        1e-14);
}

TEST_CASE_FIXTURE(Session, "sweep, optimum: relative flexibilities add columns at the end") {
  answer("sweep disks8 --epsilon 0.1W,1W --eta 0.5,inf --csv relative.csv");
  const CsvTable rows = csv("relative.csv");
  REQUIRE(rows.rows.size() == 4);
  CHECK(rows.text(0, "epsilon_relative") == "0.1");
  CHECK(rows.number(2, "epsilon") == rows.number(2, "mean_w_nn"));
  CHECK(rows.number(0, "eta") == 0.5);
  answer("sweep disks8 --epsilon 0.1W --eta 0.5W --csv both.csv");
  CHECK(read("both.csv").find(",converged,mean_w_nn,epsilon_relative,eta_relative\n") != std::string::npos);
  answer("optimum disks8 --epsilon 0.1W --csv best.csv");
  const CsvTable best = csv("best.csv");
  CHECK(best.number(0, "best_eta_relative") ==
        doctest::Approx(best.number(0, "best_eta") / best.number(0, "mean_w_nn")).epsilon(1e-14));
  check_refused("sweep disks8 --epsilon 0.1W,1 --csv -", {"epsilon: expected a W after every number"});
}
