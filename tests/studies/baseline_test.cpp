// SPDX-License-Identifier: GPL-3.0-or-later
// Every study says what it is about and has the baselines of its tables; those that take seconds are run again.
#include "../support/studies.hpp"
#include "../support/thorough.hpp"
#include "files/csv.hpp"
#include "formats/case/case_file.hpp"
#include "simulation/simulation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Tables with a larger packing are compared by tools/reproduce, which runs every study.
constexpr double largest_packing = 1000;
// Of tables with a larger one, the first case and value of each varied parameter is compared where time is short.
constexpr double small_packing = 100;

double largest_grains(const CsvText& baseline) {
  const Table table = untyped_table(baseline);
  double largest = 0;
  if (std::find(baseline.columns.begin(), baseline.columns.end(), "grains") == baseline.columns.end()) return largest;
  for (const Row& row : table.rows) largest = std::max(largest, std::get<double>(row[table.column("grains")]));
  return largest;
}

void check_columns(const StudyTable& work, const CsvText& baseline) {
  std::vector<std::string> names;
  for (const Column& column : study_columns(work)) names.push_back(column.name);
  CHECK(baseline.columns == names);
}

// That the baseline is one of this table: its columns, its rows, and what is known of them beforehand.
void check_shape(const StudyTable& work, const CsvText& baseline) {
  const Table shape{study_columns(work), {}};
  check_columns(work, baseline);
  REQUIRE(row_count(work) == static_cast<Index>(baseline.rows.size()));
  for (std::size_t i = 0; i < baseline.rows.size(); ++i)
    for (const auto& [name, cell] : known_cells(work, static_cast<Index>(i)))
      CHECK(baseline.rows[i][shape.column(name)] == to_text(cell));
}

// Leaves the first case and the first value of each varied parameter, and the rows of the baseline that have them.
void leave_first_values(StudyTable& work, CsvText& baseline) {
  work.cases.erase(work.cases.begin() + 1, work.cases.end());
  for (std::vector<Variation>* varied : {&work.vary_together, &work.vary})
    for (Variation& one : *varied) one.values.resize(1);
  REQUIRE(row_count(work));
  const Table shape{study_columns(work), {}};
  CsvText left{.columns = baseline.columns, .rows = {}};
  std::size_t next = 0;
  for (Index row = 0; row < *row_count(work); ++row) {
    const KnownCells known = known_cells(work, row);
    const auto is_known = [&](const std::vector<std::string>& cells) {
      return std::ranges::all_of(
          known, [&](const auto& one) { return cells[shape.column(one.first)] == to_text(one.second); });
    };
    while (next < baseline.rows.size() && !is_known(baseline.rows[next])) ++next;
    REQUIRE(next < baseline.rows.size());
    left.rows.push_back(baseline.rows[next++]);
  }
  baseline = left;
}

// Iterations of which the observable `indicators` has rows, of a run that ends at the last one allowed.
std::vector<Index> iterations_shown(Index last) {
  std::vector<Index> shown;
  for (Index i = 1; i <= last; ++i)
    if (i <= 20 || i == last || std::floor(40 * std::log10(i)) != std::floor(40 * std::log10(i - 1)))
      shown.push_back(i);
  return shown;
}

// The same for iterations of a step: criterion none runs them all, and what the indicators are.
void check_iterations(const StudyTable& work, const CsvText& baseline) {
  check_columns(work, baseline);
  const Table table = untyped_table(baseline);
  const auto number = [&](std::size_t row, const char* column) {
    return std::get<double>(table.rows[row][table.column(column)]);
  };
  std::size_t row = 0;
  for (Index k = 0; k < varied_case_count(work); ++k) {
    const VariedCase varied = varied_case(work, k);
    const StepSolver& solver = varied.one.spec.dynamics->solver;
    REQUIRE(solver.criterion == "none");
    for (const Index iteration : iterations_shown(solver.maximum_iterations)) {
      CAPTURE(row);
      REQUIRE(row < table.rows.size());
      CHECK(baseline.rows[row][0] == varied.one.spec.name);
      for (std::size_t c = 0; c < varied.cells.size(); ++c)
        CHECK(baseline.rows[row][1 + c] == to_text(varied.cells[c]));
      CHECK(number(row, "step") == static_cast<double>(work.steps[0]));
      CHECK(number(row, "iteration") == static_cast<double>(iteration));
      CHECK(number(row, "sweeps") == static_cast<double>(iteration * solver.gauss_seidel_sweeps));
      CHECK(number(row, "stick") + number(row, "slide") == number(row, "active"));
      CHECK(number(row, "zeta") <= 1);
      if (iteration == solver.maximum_iterations) CHECK(number(row, "zeta") < 1e-3);
      if (iteration == 1) CHECK(number(row, "interface_change") == 1);  // from F = 0
      ++row;
    }
  }
  CHECK(row == table.rows.size());
}

Packing settled(const std::string& path) {
  Simulation simulation = simulation_of(resolve(read_case(path)));
  REQUIRE(run_simulation(simulation, {}).end != RunEnd::broke_down);
  Packing result;
  for (std::size_t i = 0; i < simulation.state.x.size(); ++i) {
    if (!simulation.system.free(static_cast<Index>(i))) continue;
    result.x.push_back(simulation.state.x[i]);
    result.y.push_back(simulation.state.y[i]);
    result.radius.push_back(simulation.system.radius[i]);
    result.mass.push_back(simulation.system.mass[i]);
  }
  return result;
}

}  // namespace

TEST_CASE("predicted-observed: the rows of the smallest bed, settled afresh, equal the baseline") {
  const Study study = read_study("predicted-observed");
  StudyTable work = study.tables[0];
  const std::filesystem::path folder = source_folder() / "studies" / study.name;
  const CaseSpec spec = read_case((folder / "shear-100.toml").string());
  work.cases = {{spec, settled((folder / std::get<SettledFrom>(spec.packing).name).string())}};
  for (Variation& together : work.vary_together) together.values.resize(1);  // one sweep per iteration
  const std::string path = baseline_path(study, 0);
  CsvText baseline = parse_csv(read_text(path), path);
  baseline.rows.resize(2);
  CHECK(compare(run(work), baseline, work.check_tolerance, work.column_tolerance, work.check_relative) == "");
}

TEST_CASE("studies: folder complete, small tables equal to their baselines, large ones of the right shape") {
  int studies = 0, compared = 0, shaped = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "studies")) {
    if (!entry.is_directory()) continue;
    CAPTURE(entry.path().string());
    const std::string readme = read_text((entry.path() / "README.md").string());
    for (const char* part : {"## Question", "## What to expect", "## What was found"}) {
      CAPTURE(part);
      CHECK(readme.find(part) != std::string::npos);
    }
    if (std::filesystem::exists(entry.path() / "measure")) continue;  // a script of its own instead of a study.toml
    const Study study = read_study(entry.path().filename().string());
    for (std::size_t i = 0; i < study.tables.size(); ++i) {
      StudyTable work = study.tables[i];
      CAPTURE(work.name);
      const std::string path = baseline_path(study, i);
      if (!work.baseline || (work.large && !std::filesystem::exists(path))) continue;
      CsvText baseline = parse_csv(read_text(path), path);
      if (work.observable->moving) {  // their deposits take minutes: compared by tools/reproduce
        if (row_count(work))
          check_shape(work, baseline);
        else if (work.observable == &observables::indicators)
          check_iterations(work, baseline);
        else
          check_columns(work, baseline);
        ++shaped;
        continue;
      }
      if (work.large || largest_grains(baseline) > largest_packing) {
        check_shape(work, baseline);
        ++shaped;
        continue;
      }
      if (!thorough() && largest_grains(baseline) > small_packing) leave_first_values(work, baseline);
      CHECK(compare(run(work), baseline, work.check_tolerance, work.column_tolerance, work.check_relative) == "");
      ++compared;
    }
    ++studies;
  }
  CHECK(studies >= 12);
  CHECK(compared >= 10);
  CHECK(shaped >= 10);
}
