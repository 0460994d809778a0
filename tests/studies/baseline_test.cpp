// SPDX-License-Identifier: GPL-3.0-or-later
// Every study says what it is about and has the baselines of its tables; those that take seconds are run
// again.
#include "../support/studies.hpp"
#include <nscdd/io/csv.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Tables with a larger packing are compared by tools/reproduce, which runs every study.
constexpr double largest_packing = 1000;

double largest_grains(const CsvText& baseline) {
  const Table table = untyped_table(baseline);
  double largest = 0;
  if (std::find(baseline.columns.begin(), baseline.columns.end(), "grains") == baseline.columns.end())
    return largest;
  for (const Row& row : table.rows)
    largest = std::max(largest, std::get<double>(row[table.column("grains")]));
  return largest;
}

// That the baseline is one of this table: its columns, its rows, and what is known of them beforehand.
void check_shape(const StudyTable& work, const CsvText& baseline) {
  const Table shape{study_columns(work), {}};
  std::vector<std::string> names;
  for (const Column& column : shape.columns) names.push_back(column.name);
  CHECK(baseline.columns == names);
  REQUIRE(row_count(work) == static_cast<Index>(baseline.rows.size()));
  for (std::size_t i = 0; i < baseline.rows.size(); ++i)
    for (const auto& [name, cell] : known_cells(work, static_cast<Index>(i)))
      CHECK(baseline.rows[i][shape.column(name)] == to_text(cell));
}

}  // namespace

TEST_CASE("studies: folder complete, small tables equal to their baselines, large ones of the right shape") {
  int studies = 0, compared = 0, shaped = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "studies")) {
    if (!entry.is_directory()) continue;
    CAPTURE(entry.path().string());
    const Study study = read_study(entry.path().filename().string());
    const std::string readme = read_text((entry.path() / "README.md").string());
    for (const char* part : {"## Question", "## What to expect", "## What was found"}) {
      CAPTURE(part);
      CHECK(readme.find(part) != std::string::npos);
    }
    for (std::size_t i = 0; i < study.tables.size(); ++i) {
      const StudyTable& work = study.tables[i];
      CAPTURE(work.name);
      const std::string path = baseline_path(study, i);
      if (!work.baseline || (work.large && !std::filesystem::exists(path))) continue;
      const CsvText baseline = parse_csv(read_text(path), path);
      if (moves(work.observable)) {  // their deposits take minutes: compared by tools/reproduce
        CHECK(baseline.columns.size() == study_columns(work).size());
        ++shaped;
        continue;
      }
      if (work.large || largest_grains(baseline) > largest_packing) {
        check_shape(work, baseline);
        ++shaped;
        continue;
      }
      CHECK(compare(run(work), baseline, work.check_tolerance, work.column_tolerance) == "");
      ++compared;
    }
    ++studies;
  }
  CHECK(studies >= 12);
  CHECK(compared >= 10);
  CHECK(shaped >= 10);
}
