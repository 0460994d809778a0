// SPDX-License-Identifier: GPL-3.0-or-later
// What the studies size, scalability, disorder and partition found, on those of their packings that take seconds.
#include "../support/studies.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

StudyTable table_of(const std::string& study, const std::string& name) {
  const Study found = read_study(study);
  const auto table =
      std::find_if(found.tables.begin(), found.tables.end(), [&](const StudyTable& one) { return one.name == name; });
  REQUIRE(table != found.tables.end());
  return *table;
}

// The table with the first so many values of each parameter.
StudyTable begun(StudyTable table, std::size_t places) {
  for (auto* variations : {&table.vary_together, &table.vary})
    for (Variation& one : *variations) one.values.resize(std::min(places, one.values.size()));
  return table;
}

double number(const Table& table, const Row& row, const std::string& column) {
  const Cell& cell = row[table.column(column)];
  return std::holds_alternative<double>(cell) ? std::get<double>(cell)
                                              : static_cast<double>(std::get<std::int64_t>(cell));
}

// 1 - rho without unit eigenvalues, in the order of the rows at one eta.
std::vector<double> gaps(const Table& table, double eta) {
  std::vector<double> values;
  for (const Row& row : table.rows)
    if (number(table, row, "eta") == eta) values.push_back(1 - number(table, row, "subdominant_radius"));
  REQUIRE(values.size() > 2);
  return values;
}

double exponent(double x, double other_x, double y, double other_y) {
  return std::log(other_y / y) / std::log(other_x / x);
}

}  // namespace

TEST_CASE("any packing, any partition: rho(B_eps,eta) <= 1 - eps/eta, and a lattice all but reaches it") {
  for (const char* name : {"lattice-grid", "lattice-metis", "deposit-grid", "deposit-metis"}) {
    CAPTURE(name);
    StudyTable work = begun(table_of("partition", name), 1);
    work.sweep.eta = {0.1, 1.0};
    for (Case& one : work.cases)
      for (const char* size : {"packing.columns", "packing.rows", "packing.grains"}) try {
          override_case(one.spec, size, std::string(size) == "packing.grains" ? "500" : "24");
        } catch (const std::exception&) {  // a parameter of the other generator
        }
    const Table table = run(work);
    REQUIRE(table.rows.size() == 4);
    for (const Row& row : table.rows) {
      const double ratio = number(table, row, "epsilon") / number(table, row, "eta");
      const double gap = 1 - number(table, row, "spectral_radius");
      CHECK(gap >= ratio * (1 - 1e-9));
      if (std::string(name).find("lattice") == 0 && number(table, row, "eta") == 0.1) CHECK(gap <= 1.06 * ratio);
    }
  }
}

TEST_CASE("size: rigid contacts slow down with the size, faster in a deposit; flexible ones do not") {
  for (const char* name : {"rigid-lattice", "rigid-deposit"}) {
    CAPTURE(name);
    const Table table = run(begun(table_of("size", name), 3));
    const double grains = number(table, table.rows.front(), "grains");
    const double more = number(table, table.rows.back(), "grains");
    for (const double eta : {0.1, infinity}) {
      const std::vector<double> gap = gaps(table, eta);
      const double power = exponent(grains, more, gap.front(), gap.back());
      if (std::string(name) == "rigid-lattice") {
        CHECK(power == doctest::Approx(-0.5).epsilon(0.1));
      } else {
        CHECK(power < -0.8);
      }
    }
  }
  StudyTable flexible = begun(table_of("size", "lattice"), 3);
  flexible.sweep.epsilon = {1e-2};
  flexible.vary_together[0].values = flexible.vary_together[1].values = {"24", "32", "48"};
  const Table table = run(flexible);
  for (const double eta : {0.1, infinity}) {
    const std::vector<double> gap = gaps(table, eta);
    for (const double other : gap) CHECK(other == doctest::Approx(gap[0]).epsilon(1e-2));
  }
}

TEST_CASE("scalability: rigid strips of lattice bend (1 - rho ~ n^-4), grids go like 1/n, eta gains a factor") {
  StudyTable strips = begun(table_of("scalability", "lattice-strips"), 4);
  strips.sweep.epsilon = {0};
  const Table in_line = run(strips), in_grid = run(begun(table_of("scalability", "lattice-grids"), 3));
  for (const double eta : {0.1, infinity}) {
    const std::vector<double> line = gaps(in_line, eta), grid = gaps(in_grid, eta);
    CHECK(exponent(8, 16, line[2], line[3]) == doctest::Approx(-4).epsilon(0.03));
    CHECK(exponent(4, 16, grid[0], grid[2]) == doctest::Approx(-1).epsilon(0.08));
  }
  const std::vector<double> enriched = gaps(in_line, 0.1), generic = gaps(in_line, infinity);
  for (std::size_t i = 0; i < generic.size(); ++i)
    CHECK(enriched[i] / generic[i] == doctest::Approx(7.1).epsilon(0.03));
}

TEST_CASE("scalability: a small enough eta carries across any number of rigid strips") {
  const Table table = run(begun(table_of("scalability", "lattice-strips-eta"), 4));
  const std::vector<double> smallest = gaps(table, 1e-6), middle = gaps(table, 1e-4), largest = gaps(table, 1e-2);
  for (std::size_t i = 0; i < 3; ++i) CHECK(smallest[i] > 0.97);
  // where it does not reach it goes like n^-4 as well
  CHECK(exponent(8, 16, largest[2], largest[3]) == doctest::Approx(-4).epsilon(0.03));
  CHECK(middle[3] / largest[3] > 80);
}

TEST_CASE("scalability: with epsilon > 0 the number of subdomains does not matter") {
  StudyTable work = begun(table_of("scalability", "lattice-strips"), 4);
  work.sweep.epsilon = {1e-2};
  const Table table = run(work);
  for (const double eta : {0.1, infinity}) {
    const std::vector<double> gap = gaps(table, eta);
    for (const double other : gap) CHECK(other == doctest::Approx(gap[0]).epsilon(1e-3));
  }
}

TEST_CASE("scalability: the best eta of the nonsmooth strip buys a factor of two, and 1 - rho ~ n^-2 stays") {
  const Table table = run(begun(table_of("scalability", "best-strip"), 5));
  REQUIRE(table.rows.size() == 5);
  for (std::size_t i = 2; i < table.rows.size(); ++i) {
    const Row &row = table.rows[i], &before = table.rows[i - 1];
    const auto gap = [&](const Row& one, const char* column) { return 1 - number(table, one, column); };
    for (const char* column : {"generic_radius", "generic_relaxed_radius", "best_radius", "relaxed_best_radius"})
      CHECK(exponent(1, 2, gap(before, column), gap(row, column)) == doctest::Approx(-2).epsilon(0.05));
    CHECK(gap(row, "best_radius") / gap(row, "generic_radius") == doctest::Approx(2.06).epsilon(0.01));
    CHECK(number(table, row, "best_eta") / number(table, row, "convergent_from") < 1.03);
  }
}

TEST_CASE("disorder: vacancies slow rigid contacts down and take the indeterminacy with them") {
  StudyTable work = table_of("disorder", "vacancies");
  work.sweep.epsilon = {0};
  for (const char* size : {"packing.columns", "packing.rows"}) override_case(work.cases[0].spec, size, "32");
  work.vary = {{"packing.vacancies", {"0", "0.1", "0.2"}}};
  const Table table = run(work);
  for (const double eta : {0.1, infinity}) {
    const std::vector<double> gap = gaps(table, eta);
    CHECK(gap[1] < gap[0]);
    CHECK(gap[2] < gap[1]);
  }
  const auto indeterminate = [&](std::size_t i) {
    return number(table, table.rows[i], "unit_multiplicity") / number(table, table.rows[i], "interface_dofs");
  };
  CHECK(indeterminate(4) < indeterminate(2));
  CHECK(indeterminate(2) < indeterminate(0));
}

TEST_CASE("partition: METIS and blocks give interfaces and radii alike") {
  for (const std::string packing : {"lattice", "deposit"}) {
    CAPTURE(packing);
    std::vector<double> size, gap;
    for (const char* kind : {"-grid", "-metis"}) {
      StudyTable work = begun(table_of("partition", packing + kind), 1);
      work.sweep.epsilon = {1e-2};
      const Table table = run(work);
      size.push_back(number(table, table.rows[1], "interface_dofs"));
      gap.push_back(1 - number(table, table.rows[1], "spectral_radius"));
    }
    CHECK(size[1] / size[0] == doctest::Approx(1).epsilon(0.15));
    CHECK(gap[1] / gap[0] == doctest::Approx(1).epsilon(0.3));
  }
}
