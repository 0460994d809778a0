// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd sweep --curve: its table, and what it refuses.
#include "session.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>

using namespace nscdd::testing;

namespace {

const std::string curve = "sweep disks8 --epsilon 1e-2:1e2 --curve 1e-2 --csv -";

void check_curve_refused(const std::string& options, std::initializer_list<std::string> parts) {
  Session{}.check_refused("sweep disks8 --csv - " + options, parts);
}

}  // namespace

TEST_CASE_FIXTURE(Session, "curve: the table is that of a sweep with the band at the end") {
  const CsvTable plain = table("sweep disks8 --epsilon 1e-2,1e2");
  const CsvTable result = table("sweep disks8 --epsilon 1e-2:1e2 --curve 1e-2");
  auto expected = plain.columns;
  expected.insert(expected.end(), {"curve_low", "curve_high"});
  CHECK(result.columns == expected);
  const std::size_t last = result.rows.size() - 1;
  REQUIRE(last >= 5);
  CHECK(last < 30);
  CHECK(result.number(0, "epsilon") == 1e-2);
  CHECK(result.number(last, "epsilon") == 1e2);
  for (const std::string name : {"spectral_radius", "eigenvalue_min"}) {
    CHECK(std::abs(result.number(0, name) - plain.number(0, name)) < 1e-14);
    CHECK(std::abs(result.number(last, name) - plain.number(1, name)) < 1e-14);
  }
  for (std::size_t row = 0; row <= last; ++row) {
    const double radius = result.number(row, "subdominant_radius");
    CHECK(result.number(row, "curve_low") <= radius);
    CHECK(result.number(row, "curve_high") >= radius);
    CHECK(result.number(row, "curve_high") - result.number(row, "curve_low") <= 1e-2 * (1 + 1e-12));
    if (row > 0) CHECK(result.number(row, "epsilon") > result.number(row - 1, "epsilon"));
  }
}

TEST_CASE("curve: the closed form of 4 disks lies in the band between the rows") {
  const CsvTable result = Session{}.table("sweep disks4 --epsilon 1e-3:1e3 --curve 1e-3");
  for (std::size_t row = 1; row < result.rows.size(); ++row)
    for (const double t : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const double from = result.number(row - 1, "epsilon"), to = result.number(row, "epsilon");
      const double e = from * std::pow(to / from, t);
      const double a = 4 * e * e * e + 44 * e * e + 153 * e + 168, b = 16 * e * e + 108 * e + 174;
      const double radius = std::max((b + std::sqrt(b * b - 4 * a * (15 * e + 42))) / (2 * a), 3 / (5 + 2 * e));
      const auto between = [&](const std::string& name) {
        return std::lerp(result.number(row - 1, name), result.number(row, name), t);
      };
      CHECK(between("curve_low") <= radius + 1e-13);
      CHECK(between("curve_high") >= radius - 1e-13);
    }
}

TEST_CASE_FIXTURE(Session, "curve: one for every value of the other list, equal bytes twice, relative values, HDF5") {
  const CsvTable result = table("sweep disks8 --epsilon 0,1 --eta 0.1:10 --curve 0.05 --contacts active");
  std::size_t starts = 0;
  for (std::size_t row = 0; row < result.rows.size(); ++row) starts += result.number(row, "eta") == 0.1;
  CHECK(starts == 2);
  CHECK(answer(curve) == answer(curve));
  const CsvTable relative = table("sweep disks8 --epsilon 0.01:10W --curve 0.05 --certify");
  CHECK(relative.number(0, "epsilon_relative") == 0.01);
  CHECK(relative.text(0, "certified") == "true");
  CHECK(relative.columns.back() == "curve_high");
  answer("sweep disks8 --epsilon 1:10 --curve 0.05 --csv a.csv --hdf5 a.h5");
  CHECK(has("a.csv"));
  CHECK(has("a.h5"));
  CHECK(!has("a.csv.record"));
}

TEST_CASE("curve: what is not one range, and what cannot be proved, is refused by name") {
  for (const std::string spec : {"1", "1,2", "1e-2:1e2:9", "1:2:3:linear", "1:2,4"})
    check_curve_refused("--epsilon " + spec + " --curve 1e-3", {"--curve", "FROM:TO", spec});
  check_curve_refused("--epsilon 1:2 --eta 1:2 --curve 1e-3", {"--curve", "FROM:TO"});
  for (const std::string range : {"0:1", "2:1", "1:inf", "1:1", "x:2"})
    check_curve_refused("--epsilon " + range + " --curve 1e-3", {"epsilon"});
  check_curve_refused("--epsilon 1 --eta 0:1 --curve 1e-3", {"eta", "FROM < TO"});
  for (const std::string tolerance : {"0", "-1", "nan", "inf"})
    check_curve_refused("--epsilon 1:2 --curve=" + tolerance, {"--curve", "> 0", tolerance});
  check_curve_refused("--epsilon 1:2 --curve 1e-3 --gauss-seidel-sweeps 3", {"--gauss-seidel-sweeps", "inf", "3"});
  check_curve_refused("--epsilon 1:2 --curve 1e-3 --relaxation optimal", {"--relaxation", "--curve", "optimal"});
  check_curve_refused("--epsilon 1:2 --curve 1e-3 --solver arpack", {"--solver", "--curve", "arpack"});
  check_curve_refused("--epsilon 1:2 --curve 1e-3 --resume", {"--resume", "--curve"});
  check_curve_refused("--epsilon 1:2", {"epsilon", "FROM:TO:COUNT"});
}

TEST_CASE_FIXTURE(Session, "curve: one that is not proved tells so, with exit code 1") {
  const auto outcome = run(curve + " --residual-tolerance 1e-300");
  CHECK(outcome.exit_code == 1);
  CHECK(contains(outcome.standard_error, "1 of 1 curves"));
  CHECK(contains(outcome.standard_error, "did not converge"));
  CHECK(contains(outcome.standard_output, ",nan,nan"));
}

TEST_CASE_FIXTURE(Session, "curve: an interrupted run leaves no file, because it is not resumed") {
  // The signal comes while the first curve is written, so the second one is not begun.
  ended(130, "sweep disks8 --epsilon 1e-4:1e4 --eta inf,0.3 --curve 1e-5 --csv x.csv",
        {"x.csv: interrupted", "not resumed"}, {.signal_at = SignalAt{"x.csv.partial", 8000, SIGINT}});
  for (const std::string name : {"x.csv", "x.csv.partial", "x.csv.record"}) CHECK(!has(name));
}
