// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/tables/study.hpp"

#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "../support/studies.hpp"
#include "study/linear/inspection.hpp"
#include "study/linear/values.hpp"
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("SPEC: numbers, lists, ranges with exact ends, and mixtures") {
  CHECK(parse_values("0.5", "x") == std::vector<double>{0.5});
  CHECK(parse_values("1,inf,2", "x") == std::vector<double>{1, infinity, 2});
  CHECK(parse_values("1e-3:1e3:7", "x") == std::vector<double>{1e-3, 1e-2, 1e-1, 1, 10, 100, 1e3});
  CHECK(parse_values("0:1:5:linear", "x") == std::vector<double>{0, 0.25, 0.5, 0.75, 1});
  CHECK(parse_values("5:1:3:linear", "x") == std::vector<double>{5, 3, 1});
  CHECK(parse_values("inf,0,1:100:3", "x") == std::vector<double>{infinity, 0, 1, 10, 100});
  CHECK(parse_values("2:2:1", "x") == std::vector<double>{2});
  for (int end = 2; end < 60; ++end) {  // 10 to the power of a logarithm is off by rounding for many of them
    const std::string text = std::to_string(end);
    CHECK(parse_values("1:" + text + ":3", "x").back() == end);
    CHECK(parse_values(text + ":100:3", "x").front() == end);
  }
}

TEST_CASE("SPEC: nonsense is refused by name") {
  for (const char* spec : {"", ",", "1,", "a", "1:2", "1:2:3:4", "1:2:3:quadratic", "0:1:5", "-1:1:5", "1:2:0", "1:2:1",
                           "1:2:2.5", "1:2:-3", "1:inf:3", "nan:1:3", "1:2:1000000000", "1:2:3:linear:4", "1;2"}) {
    CAPTURE(spec);
    CHECK_THROWS_WITH_AS(parse_values(spec, "quantity"), doctest::Contains("quantity"), Error);
  }
  for (const char* spec : {"-1", "inf", "nan", "1,-1e-9"}) CHECK_THROWS_AS(parse_epsilon(spec), Error);
  for (const char* spec : {"0", "-1", "nan", "-inf", "0:1:3:linear"}) CHECK_THROWS_AS(parse_eta(spec), Error);
  for (const char* spec : {"0", "-1", "inf", "best"}) CHECK_THROWS_AS(parse_relaxation(spec), Error);
  for (const char* spec : {"0", "1.5", "-inf", "nan", "1e10"}) CHECK_THROWS_AS(parse_sweeps(spec), Error);
  CHECK(parse_epsilon("0").first == std::vector<double>{0});
  CHECK(parse_eta("inf").first[0] == infinity);
  CHECK(parse_relaxation("1, optimal") == std::vector<std::optional<double>>{1.0, std::nullopt});
  CHECK(parse_epsilon("0.1 W , 1W").first == std::vector{0.1, 1.0});
  CHECK(parse_sweeps("1:3:3:linear,inf") == std::vector<std::optional<long>>{1, 2, 3, std::nullopt});
}

TEST_CASE("SPEC: flexibilities relative to the packing have a W after every number") {
  const FlexibilityValues mixed = parse_eta("0.5W,1:100:3 W,inf");
  CHECK(mixed.second);
  CHECK(mixed.first == std::vector<double>{0.5, 1, 10, 100, infinity});
  CHECK(parse_epsilon("0,2 W").second);
  CHECK(parse_epsilon("1:3:3:linear W").first == std::vector<double>{1, 2, 3});
  CHECK_FALSE(parse_epsilon("0,2").second);
  CHECK_THROWS_WITH_AS(parse_epsilon("1,2W"), doctest::Contains("a W after every number or after none"), Error);
  for (const char* spec : {"W", "1WW", "1w", "1:2W:3", "-1W", ",W"}) CHECK_THROWS_AS(parse_eta(spec), Error);
}

TEST_CASE("scale of flexibilities: the mean of 1/m_i + 1/m_j over the contacts") {
  Case one = testing::strip(4);  // contacts 01, 02, 12, 13, 23
  one.spec.packing = PackingFile{"four"};
  one.packing = build(testing::strip(4)).packing;
  one.packing.mass = {1, 2, 4, 8};
  CHECK(mean_normal_delassus(build(one).problem) ==
        doctest::Approx((2 * (1 + 0.125) + 3 * (0.5 + 0.25)) / 5).epsilon(1e-14));
}

TEST_CASE("case: parameters overridden by name, unknown ones refused with those there are") {
  Case one = strip(4);
  override_case(one.spec, "packing.grains", "12");
  override_case(one.spec, "partition.grid", "3,1");
  override_case(one.spec, "contacts.tolerance", "1e-5");
  override_case(one.spec, "masses.density", "2.5");
  const Model model = build(one);
  CHECK(model.packing.size() == 12);
  CHECK(model.partition.subdomains == 3);
  CHECK(model.problem.arriving_velocity[22] == -1.0);  // grain -1 is the last, also of twelve
  CHECK_THROWS_WITH_AS(override_case(one.spec, "packing.columns", "3"),
                       doctest::Contains("packing.grains, packing.radius"), Error);
  CHECK_THROWS_AS(override_case(one.spec, "packing", "3"), Error);
  CHECK_THROWS_AS(override_case(one.spec, "color", "3"), Error);
  CHECK_THROWS_AS(override_case(one.spec, "packing.grains", "0"), Error);
  one.spec.packing = PackingFile{"a.csv"};
  one.packing = model.packing;
  CHECK_THROWS_WITH_AS(override_case(one.spec, "packing.grains", "3"), doctest::Contains("is a file"), Error);
}

TEST_CASE("case: a prescribed grain beyond the packing is refused") {
  Case one = strip(4);
  one.spec.prescribed = {{4, {1.0, 0.0}}};
  CHECK_THROWS_WITH_AS(build(one), doctest::Contains("expected a grain in 0..3"), Error);
  one.spec.prescribed = {{-5, {1.0, 0.0}}};
  CHECK_THROWS_AS(build(one), Error);
}

TEST_CASE("sweep: one row per point, last list fastest, columns in place") {
  SweepParameters parameters;
  parameters.epsilon = {0, 1};
  parameters.eta = {0.5, infinity};
  parameters.relaxation = {1.0, std::nullopt};
  const Table layout{headings(sweep_columns()), {}};
  std::vector<Row> rows;
  Index reported = 0;
  const Index failed = sweep(
      build(strip(8)), parameters, [&](const SweepResult& result) { rows.push_back(row(sweep_columns(), result)); },
      [&](Index done, Index total) {
        CHECK(total == 8);
        reported = done;
        return true;
      });
  CHECK(failed == 0);
  CHECK(reported == 8);
  REQUIRE(rows.size() == 8);
  for (const Row& row : rows) REQUIRE(row.size() == layout.columns.size());
  CHECK(std::get<double>(rows[0][layout.column("eta")]) == 0.5);
  CHECK(std::get<double>(rows[2][layout.column("eta")]) == infinity);
  CHECK(std::get<double>(rows[4][layout.column("epsilon")]) == 1);
  CHECK(std::get<double>(rows[3][layout.column("relaxation")]) > 1);
  CHECK(std::get<double>(rows[3][layout.column("spectral_radius")]) <
        std::get<double>(rows[2][layout.column("spectral_radius")]));
}

TEST_CASE("sweep: relative flexibilities are those of the packing, and do not depend on the unit of mass") {
  SweepParameters relative;
  std::tie(relative.epsilon, relative.relative_epsilon) = parse_epsilon("0.1W");
  std::tie(relative.eta, relative.relative_eta) = parse_eta("0.5W");
  const auto swept = [](const Case& one, const SweepParameters& parameters) {
    SweepResult found;
    sweep(build(one), parameters, [&](const SweepResult& result) { found = result; });
    return found;
  };
  Case light = strip(8), heavy = strip(8);
  light.spec.masses = {MassModel::density, 1.0};
  heavy.spec.masses = {MassModel::density, 1000.0};
  const SweepResult first = swept(light, relative), second = swept(heavy, relative);
  CHECK(first.scale == doctest::Approx(1000 * second.scale).epsilon(1e-12));
  CHECK(first.radius.value == doctest::Approx(second.radius.value).epsilon(1e-10));
  SweepParameters absolute;
  absolute.epsilon = {0.1 * second.scale};
  absolute.eta = {0.5 * second.scale};
  CHECK(swept(heavy, absolute).radius.value == doctest::Approx(second.radius.value).epsilon(1e-12));
  CHECK(first.radius.value > 0.1);
}

TEST_CASE("sweep: a radius of contacts that were chosen from inaccurate impulses has not converged") {
  Case one = strip(12);
  one.spec.packing = PackingFile{"uneven"};
  one.spec.prescribed = {{.grain = 0, .velocity = {1, 0}}};
  one.packing = build(strip(12)).packing;
  for (const double heavy : {1.0, 1e14}) {  // rounding of the heavy grains is as much as the light ones have
    CAPTURE(heavy);
    for (std::size_t i = 0; i < 12; i += 3) one.packing.mass[i] = heavy;
    SweepParameters parameters;
    parameters.contacts = ContactSet::active;
    const Index failed = sweep(build(one), parameters, [&](const SweepResult& result) {
      CHECK(result.radius.residual < 1e-12);
      CHECK(result.radius.converged == (heavy == 1));
    });
    CHECK(failed == (heavy == 1 ? 0 : 1));
  }
}

TEST_CASE("sweep: a monitor that says stop stops it; optimal relaxation needs an exact Stage 1") {
  SweepParameters parameters;
  parameters.epsilon = {1, 2, 3, 4};
  Index rows = 0;
  sweep(
      build(strip(4)), parameters, [&](const SweepResult&) { ++rows; }, [](Index done, Index) { return done < 2; });
  CHECK(rows == 2);
  parameters.relaxation = {std::nullopt};
  parameters.gauss_seidel_sweeps = {3};
  CHECK_THROWS_AS(sweep(build(strip(4)), parameters, [](const SweepResult&) {}), Error);
}

TEST_CASE("inspection: 12 disks isostatic; a lattice hyperstatic with cross points") {
  const Inspection found = inspect(build(strip(12)));
  CHECK((found.whole.rank == 21 && found.whole.hyperstaticity == 0));
  CHECK((found.whole.rigid_modes == 3 && found.components == 1));
  CHECK(found.isolated_grains == 0);
  CHECK(found.coordination_number == doctest::Approx(3.5));
  CHECK(found.interface_grains.at(2) == 2);
  CHECK(found.unit_multiplicity == 0);

  Case lattice;
  lattice.spec.packing = Generator{HexagonalLattice{.columns = 6, .rows = 6}};
  lattice.spec.partition = GridPartitioner{{2, 2}};
  const Inspection hyper = inspect(build(lattice));
  CHECK(hyper.whole.contacts == 85);
  CHECK(hyper.whole.rank == 72 - 3);
  CHECK(hyper.whole.hyperstaticity == 85 - 69);
  CHECK(hyper.unit_multiplicity > 0);
  CHECK(hyper.interface_grains.size() >= 2);

  Case apart;
  apart.spec.packing = PackingFile{"three grains"};
  apart.packing = {{0.0, 2.0, 9.0}, {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}, {}};
  apart.spec.partition = GridPartitioner{{3, 3}};
  const Inspection sparse = inspect(build(apart));
  CHECK((sparse.isolated_grains == 1 && sparse.components == 1));
  CHECK(sparse.empty_subdomains == 8);
}

TEST_CASE("optimum: nothing to optimise is told as such") {
  Case single = strip(8);
  single.spec.partition = GridPartitioner{{1, 1}};
  CHECK(optimum_of(build(single)).status == OptimumStatus::no_interface);
  const Optimum isostatic = optimum_of(build(strip(8)), 0, ContactSet::all);
  CHECK(isostatic.status == OptimumStatus::eta_to_zero);
  CHECK(isostatic.radius < 1e-6);
  CHECK(isostatic.convergent_from == 0);
  const Optimum four = optimum_of(build(strip(4)));
  CHECK(four.relaxed_status == OptimumStatus::eta_to_infinity);
  CHECK(four.relaxed_radius == doctest::Approx(4.0 / 11));
}

TEST_CASE("network: links and grains of the 4 disks, and of spheres with normals, places and velocities along z") {
  const auto tables_of = [](const Model& model, Index dimension) {
    Table link{headings(link_columns(ContactSet::active, dimension)), {}};
    Table grain{headings(grain_columns(dimension)), {}};
    links(model, [&](const Link& one) { link.rows.push_back(row(link_columns(ContactSet::active, dimension), one)); });
    grains(model, [&](const PackingGrain& one) { grain.rows.push_back(row(grain_columns(dimension), one)); });
    for (const Row& cells : link.rows) {
      REQUIRE(cells.size() == link.columns.size());
      const auto number = [&](const std::string& name) { return std::get<double>(cells[link.column(name)]); };
      for (const std::string axis : {"x", "y", "z"})
        if (axis != "z" || dimension == 3)
          CHECK(number("normal_" + axis) ==
                doctest::Approx(number(axis + "_b") - number(axis + "_a")));  // of diameter 1 m
      CHECK(std::get<bool>(cells[link.column("active")]) == (number("impulse") > 0));
      CHECK(std::get<std::string>(cells[link.column("impulse_solution")]) == "unique");
    }
    return std::pair(link, grain);
  };
  const auto [link, grain] = tables_of(build(strip(4)), 2);
  REQUIRE(link.rows.size() == 5);
  REQUIRE(grain.rows.size() == 4);
  CHECK(std::get<std::int64_t>(grain.rows[1][grain.column("multiplicity")]) == 2);
  CHECK(std::get<double>(grain.rows[3][grain.column("velocity_x")]) == -1.0);

  const auto [link_of_spheres, sphere] = tables_of(build(two_tetrahedra()), 3);
  REQUIRE(link_of_spheres.rows.size() == 9);
  REQUIRE(sphere.rows.size() == 5);
  CHECK(link_of_spheres.columns.size() == link_columns().size() + 3);
  CHECK(sphere.columns.size() == grain_columns().size() + 2);
  CHECK(std::get<double>(sphere.rows[4][sphere.column("z")]) == doctest::Approx(std::sqrt(2.0 / 3.0)));
  CHECK(std::get<double>(sphere.rows[4][sphere.column("velocity_z")]) == -0.5);
  CHECK(std::get<double>(sphere.rows[4][sphere.column("velocity_y")]) == 0.25);
  CHECK(std::get<std::int64_t>(sphere.rows[2][sphere.column("multiplicity")]) == 2);
}

TEST_CASE("study: tables of links and grains have the columns of the dimension of their cases, which is one") {
  StudyTable table;
  table.name = "both";
  table.observable = &observables::links;
  table.cases = {two_tetrahedra(), octahedron()};
  CHECK(dimension_of(table) == 3);
  CHECK(study_columns(table).size() == link_columns().size() + 3);
  Index rows = 0;
  run_table(table, [&](const Row& row) { rows += row.size() == study_columns(table).size(); });
  CHECK(rows == 9 + 12);
  table.cases.push_back(strip(4));
  CHECK_THROWS_WITH_AS(
      study_columns(table),
      "table both: expected cases of one dimension, met two tetrahedra in space and strip4 in the plane", Error);
  // What is not read yet does not count, and alone may have any column.
  Case unread;
  unread.spec.packing = PackingFile{"spheres.csv"};
  table.cases = {unread, octahedron()};
  CHECK(dimension_of(table) == 3);
  table.cases = {unread, strip(4)};
  CHECK(dimension_of(table) == 2);
  table.cases = {unread};
  CHECK(study_columns(table).size() == link_columns().size() + 3);
  table.cases = {octahedron(), strip(4)};
  table.observable = &observables::spectral_radius;  // has no columns along z
  table.sweep.epsilon = {0.1};
  CHECK(study_columns(table).size() == headings(sweep_columns(table.sweep)).size());
  table.observable = &observables::links;
  table.cases = {strip(4)};
  CHECK(study_columns(table).size() == link_columns().size());
}

TEST_CASE("study: the rows of a packing in space are not those of another with other z") {
  StudyTable one;
  one.cases = {two_tetrahedra()};
  StudyTable other = one;
  other.cases[0].packing.z[4] += 1e-15;
  REQUIRE(other.cases[0].packing.z[4] != one.cases[0].packing.z[4]);
  CHECK(work_identity(one).cases != work_identity(other).cases);
}

TEST_CASE("study: variations become columns, every combination a block of rows") {
  StudyTable table;
  table.cases = {strip(4), strip(8)};
  table.vary = {{"packing.radius", {"0.5", "1"}}, {"partition.grid", {"2,1", "3,1"}}};
  table.sweep.epsilon = {0.1, 1};
  const auto [columns, rows] = run(table);
  CHECK(columns[1].name == "packing.radius");
  CHECK(columns[2].name == "partition.grid");
  REQUIRE(rows.size() == 16);
  for (const Row& row : rows) REQUIRE(row.size() == columns.size());
  CHECK(std::get<double>(rows[0][1]) == 0.5);
  CHECK(std::get<std::string>(rows[2][2]) == "3,1");
  CHECK(std::get<double>(rows[4][1]) == 1.0);
  // unit masses: the radius of the disks is a length and changes nothing
  const std::size_t radius = Table{columns, {}}.column("spectral_radius");
  CHECK(std::get<double>(rows[0][radius]) == doctest::Approx(std::get<double>(rows[4][radius])).epsilon(1e-12));
}

TEST_CASE("study: a varied parameter is a column of numbers, or of words where one of its values is a word") {
  StudyTable table;
  table.cases = {strip(4)};
  table.sweep.epsilon = {1};
  table.vary = {{"packing.grains", {"4", "8"}}};
  CHECK(known_cells(table, 0).at(1).second == Cell(4.0));
  table.vary = {{"solver.eta", {"4", "optimal"}}};
  CHECK(known_cells(table, 0).at(1).second == Cell(std::string("4")));
  CHECK(known_cells(table, 1).at(1).second == Cell(std::string("optimal")));
}

TEST_CASE("study: parameters that vary together run through their lists at once, outside the other ones") {
  StudyTable table;
  table.cases = {strip(4)};
  table.vary_together = {{"packing.grains", {"4", "8", "12"}}, {"partition.grid", {"2,1", "4,1", "6,1"}}};
  table.vary = {{"packing.radius", {"0.5", "1"}}};
  CHECK(varied_case_count(table) == 6);
  CHECK(row_count(table) == 6);
  const Table found = run(table);
  CHECK((found.columns[1].name == "packing.grains" && found.columns[2].name == "partition.grid"));
  CHECK(found.columns[3].name == "packing.radius");
  REQUIRE(found.rows.size() == 6);
  for (std::size_t i = 0; i < found.rows.size(); ++i) {
    const auto cell_of = [&](const std::string& name) { return found.rows[i][found.column(name)]; };
    const std::int64_t grains = 4 * (static_cast<std::int64_t>(i) / 2 + 1);
    CHECK(std::get<std::int64_t>(cell_of("grains")) == grains);
    CHECK(std::get<std::int64_t>(cell_of("subdomains")) == grains / 2);
    CHECK(std::get<double>(cell_of("packing.radius")) == (i % 2 == 0 ? 0.5 : 1.0));
    for (const auto& [name, cell] : known_cells(table, static_cast<Index>(i))) CHECK(cell_of(name) == cell);
  }
}
