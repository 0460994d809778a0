// SPDX-License-Identifier: GPL-3.0-or-later
// What resuming rests on: rows known by number, records that tell work apart, cells that read back to the bit.
#include "../support/problems.hpp"
#include "../support/run_program.hpp"
#include "core/text.hpp"
#include "files/resumable_table.hpp"
#include "study/tables/study.hpp"
#include <nscdd/core/table.hpp>

#include <doctest/doctest.h>

#include <bit>

using namespace nscdd;

namespace {

StudyTable two_variations() {
  StudyTable table;
  table.name = "radius";
  table.cases = {testing::strip(4), testing::strip(6)};
  table.vary = {{"packing.grains", {"4", "8", "12"}}, {"contacts.tolerance", {"1e-7", "1e-6"}}};
  table.sweep.epsilon = {0.5, 1.0};
  table.sweep.eta = {0.1, infinity};
  table.sweep.relaxation = {1.0, std::nullopt};
  return table;
}

std::vector<Row> rows_of(const StudyTable& table, Index first = 0) {
  std::vector<Row> rows;
  run_table(
      table, [&](const Row& row) { rows.push_back(row); }, {}, first);
  return rows;
}

std::vector<std::string> texts(const Row& row) {
  std::vector<std::string> all;
  for (const Cell& cell : row) all.push_back(to_text(cell));
  return all;
}

}  // namespace

TEST_CASE("fingerprint: the published values of FNV-1a") {
  CHECK(fingerprint("") == "cbf29ce484222325");
  CHECK(fingerprint("a") == "af63dc4c8601ec8c");
  CHECK(fingerprint("foobar") == "85944171f73967e8");
  const std::vector<double> zero{0.0}, minus_zero{-0.0};
  CHECK(fingerprint(zero) != fingerprint(minus_zero));
  CHECK(build_fingerprint().size() == 16);
}

TEST_CASE("sweep points: the last list runs fastest") {
  SweepParameters parameters;
  parameters.epsilon = {1, 2};
  parameters.eta = {3, 4, 5};
  parameters.relaxation = {std::nullopt, 0.5};
  parameters.gauss_seidel_sweeps = {7, std::nullopt};
  REQUIRE(point_count(parameters) == 24);
  Index number = 0;
  for (const double epsilon : parameters.epsilon)
    for (const double eta : parameters.eta)
      for (const auto& relaxation : parameters.relaxation)
        for (const auto& sweeps : parameters.gauss_seidel_sweeps) {
          const SweepPoint point = sweep_point(parameters, number++);
          CHECK((point.epsilon == epsilon && point.eta == eta));
          CHECK((point.relaxation == relaxation && point.gauss_seidel_sweeps == sweeps));
        }
}

TEST_CASE("study tables: rows from any number on are those of the whole, and known before") {
  StudyTable table = two_variations();
  for (const Observable* observable : {&observables::spectral_radius, &observables::optimum}) {
    table.observable = observable;
    const std::vector<Row> whole = rows_of(table);
    REQUIRE(row_count(table) == count(whole));
    const Table layout{study_columns(table), {}};
    for (Index number = 0; number < count(whole); ++number) {
      const auto known = known_cells(table, number);
      CHECK(known.size() >= 4);
      for (const auto& [column, cell] : known) CHECK(whole[at(number)][layout.column(column)] == cell);
    }
    for (const Index first : {Index{1}, count(whole) / 2 + 1, count(whole) - 1, count(whole)}) {
      const std::vector<Row> tail = rows_of(table, first);
      REQUIRE(count(tail) == count(whole) - first);
      for (Index i = 0; i < count(tail); ++i) CHECK(texts(tail[at(i)]) == texts(whole[at(first + i)]));
    }
  }
  table.observable = &observables::links;
  CHECK(!row_count(table));
  CHECK_THROWS_AS(rows_of(table, 1), Error);
}

TEST_CASE("study tables: the monitor counts rows and stops between any two") {
  const StudyTable table = two_variations();
  Index seen = 0;
  std::vector<Row> rows;
  run_table(
      table, [&](const Row& row) { rows.push_back(row); },
      [&](Index done, Index total) {
        CHECK(done == ++seen);
        CHECK(total == *row_count(table));
        return done < 11;
      });
  CHECK(rows.size() == 11);
}

TEST_CASE("work records: equal for equal work, different for anything that rows depend on") {
  const StudyTable table = two_variations();
  CHECK(difference(work_identity(table), work_identity(table)) == "");
  const auto changed = [&](auto&& change) {
    StudyTable other = table;
    change(other);
    return difference(work_identity(table), work_identity(other));
  };
  CHECK(changed([](StudyTable& t) { t.name = "other name"; }) == "");
  CHECK(changed([](StudyTable& t) { t.cases[1].spec.masses = {MassModel::density, 2.0}; }).find("case") < 10);
  for (const std::string& found : {changed([](StudyTable& t) { t.sweep.epsilon[0] = 0.5000000001; }),
                                   changed([](StudyTable& t) { t.sweep.eta.pop_back(); }),
                                   changed([](StudyTable& t) { t.sweep.relative_epsilon = true; }),
                                   changed([](StudyTable& t) { t.sweep.relative_eta = true; }),
                                   changed([](StudyTable& t) { t.sweep.relaxation.pop_back(); }),
                                   changed([](StudyTable& t) { t.sweep.gauss_seidel_sweeps = {3}; }),
                                   changed([](StudyTable& t) { t.sweep.contacts = ContactSet::active; }),
                                   changed([](StudyTable& t) { t.sweep.contacts = ContactSet::unilateral; }),
                                   changed([](StudyTable& t) { t.vary[0].values[1] = "10"; }),
                                   changed([](StudyTable& t) { std::swap(t.vary, t.vary_together); }),
                                   changed([](StudyTable& t) { t.observable = &observables::optimum; }),
                                   changed([](StudyTable& t) { t.seed = 2; })}) {
    CAPTURE(found);
    CHECK(found.find("choice of options differs") != std::string::npos);
  }
  for (const std::string& found : {changed([](StudyTable& t) { t.sweep.spectral.solver = SpectralSolver::arpack; }),
                                   changed([](StudyTable& t) { t.sweep.spectral.tolerance = 1e-7; }),
                                   changed([](StudyTable& t) { t.sweep.spectral.dense_limit = 1; }),
                                   changed([](StudyTable& t) { t.sweep.spectral.arpack.maximum_restarts = 1; })}) {
    CAPTURE(found);
    CHECK(found.find("solver options differs") != std::string::npos);
  }
}

TEST_CASE("work records: active and unilateral contacts are different work") {
  StudyTable active = two_variations(), unilateral = active;
  active.sweep.contacts = ContactSet::active;
  unilateral.sweep.contacts = ContactSet::unilateral;
  CHECK(difference(work_identity(active), work_identity(unilateral)).find("choice of options") != std::string::npos);
}

TEST_CASE("work records: the last of many values counts, and the content of a packing rather than its path") {
  StudyTable table = two_variations();
  table.vary.clear();
  table.sweep.epsilon.assign(1000, 1.0);
  StudyTable other = table;
  other.sweep.epsilon[500] = std::nextafter(1.0, 2.0);
  CHECK(difference(work_identity(table), work_identity(other)) != "");
  table.cases = {testing::random_lattice(1, 4, 4, {2, 1})};
  other = table;
  std::get<PackingFile>(other.cases[0].spec.packing).path = "elsewhere/made in a test";
  CHECK(difference(work_identity(table), work_identity(other)) == "");
  other.cases[0].packing.mass[3] *= 1 + 1e-15;
  CHECK(difference(work_identity(table), work_identity(other)) != "");
}

TEST_CASE("record files: read back to what was written, whatever it holds") {
  TableRecord record;
  record.work = {"a \"\"\"\"\"\" b\n", "back\\slash \\\"\n'''\n", "\n", ""};
  record.types = {"text", "number"};
  record.finished = "0123";
  const TableRecord met = parse_record(to_toml(record), "x");
  CHECK(difference(record.work, met.work) == "");
  CHECK((met.types == record.types && met.finished == record.finished));
  CHECK_THROWS_AS(parse_record("version = \"\"", "x"), Error);
  CHECK_THROWS_AS(parse_record(to_toml(record) + "more = 1\n", "x"), Error);
}

TEST_CASE("resumed rows: whole ones are kept, one cut short is not, and no more than the work has are taken") {
  const testing::TemporaryFolder folder;
  const std::string path = folder / "table.csv", partial = path + ".partial";
  const TableWork work{
      {"version", "cases", "options", "effort"}, {{"row", "", ""}, {"square", "", ""}}, 3, [](Index row) {
        return std::vector<std::pair<std::string, Cell>>{{"row", row}};
      }};
  const Reopening resume{.resume = true};
  {
    ResumableTable table(path, work, resume);
    table.write({std::int64_t{0}, 0.0});
    table.leave();
  }
  const auto kept = [&](const std::string& rows) {
    testing::write_file(partial, "row,square\n" + rows);
    return kept_rows(path, work, resume).rows;
  };
  CHECK(kept("0,0\n1,1\n") == 2);
  CHECK(kept("0,0\n1,1\n2") == 2);
  CHECK(kept("0,0\n1,1\n2\n") == 2);
  CHECK(kept("0,0\n1,1\n2,4\n") == 3);
  CHECK_THROWS_WITH_AS(kept("0,0\n1,1\n2,4\n3,9\n"), doctest::Contains("3 rows at the most"), Error);
  CHECK_THROWS_WITH_AS(kept("0,0\n2,4\n"), doctest::Contains("expected 1, met 2"), Error);
}

TEST_CASE("cells read back to the last bit") {
  const Row row{std::int64_t{-3},    0.1 + 0.2, 5e-324, -0.0, infinity, -infinity, not_a_number, true, false,
                std::string("true"), 1.0};
  const std::vector<std::string> types = cell_types(row);
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Cell met = parse_cell(to_text(row[i]), types[i], "x");
    REQUIRE(met.index() == row[i].index());
    if (const auto* number = std::get_if<double>(&row[i])) {
      CHECK(std::bit_cast<std::uint64_t>(std::get<double>(met)) == std::bit_cast<std::uint64_t>(*number));
    } else {
      CHECK(met == row[i]);
    }
  }
  CHECK_THROWS_AS(parse_cell("1.5", "integer", "x"), Error);
  CHECK_THROWS_AS(parse_cell("maybe", "boolean", "x"), Error);
}
