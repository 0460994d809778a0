// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study.hpp"

#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

namespace nscdd {
namespace {

// Rows per case, if they are known.
std::optional<Index> rows_per_case(const StudyTable& table) {
  if (table.observable->rows == nullptr) return std::nullopt;
  return table.observable->rows(table);
}

// The value at a place of a list, as a cell. A column has one type: numbers if every value of the list is one,
// else texts.
Cell cell_of(const std::vector<std::string>& values, Index place) {
  try {
    std::vector<double> numbers;
    for (const std::string& value : values) numbers.push_back(parse_number(value, "value"));
    return numbers[at(place)];
  } catch (const Error&) {
    return values[at(place)];
  }
}

// Places in the lists of the parameters that change at once.
Index places_together(const StudyTable& table) {
  return table.vary_together.empty() ? 1 : count(table.vary_together[0].values);
}

// One of the cases with a place in the list of each varied parameter, in the order of their columns.
struct Combination {
  const Case& base;
  std::vector<std::pair<const Variation&, Index>> places;
};

Combination combination_of(const StudyTable& table, Index number) {
  Index stride = varied_case_count(table) / count(table.cases);
  Combination combination{table.cases[at(number / stride)], {}};
  Index rest = number % stride;
  stride /= places_together(table);
  for (const Variation& variation : table.vary_together) combination.places.emplace_back(variation, rest / stride);
  for (const Variation& variation : table.vary) {
    rest %= stride;
    stride /= count(variation.values);
    combination.places.emplace_back(variation, rest / stride);
  }
  return combination;
}

}  // namespace

std::vector<Column> study_columns(const StudyTable& table) {
  std::vector<Column> columns = table.observable->columns(table);
  auto place = columns.begin() + 1;
  for (const auto& variations : {table.vary_together, table.vary})
    for (const Variation& variation : variations)
      place = columns.insert(place, {variation.parameter, "", "parameter of the case, varied by the study"}) + 1;
  return columns;
}

std::optional<Index> row_count(const StudyTable& table) {
  const auto rows = rows_per_case(table);
  return rows ? std::optional(*rows * varied_case_count(table)) : std::nullopt;
}

KnownCells known_cells(const StudyTable& table, Index row) {
  const auto rows = rows_per_case(table);
  if (!rows) return {};
  const auto [base, places] = combination_of(table, row / *rows);
  KnownCells cells{{"case", base.spec.name}};
  for (const auto& [variation, place] : places)
    cells.emplace_back(variation.parameter, cell_of(variation.values, place));
  const KnownCells more = table.observable->known(table, row % *rows);
  cells.insert(cells.end(), more.begin(), more.end());
  return cells;
}

Index varied_case_count(const StudyTable& table) {
  Index combinations = places_together(table);
  for (const Variation& variation : table.vary) combinations *= count(variation.values);
  return combinations * count(table.cases);
}

VariedCase varied_case(const StudyTable& table, Index number) {
  const auto [base, places] = combination_of(table, number);
  VariedCase varied{base, {}};
  for (const auto& [variation, place] : places) {
    varied.cells.push_back(cell_of(variation.values, place));
    override_case(varied.one.spec, variation.parameter, variation.values[at(place)]);
  }
  return varied;
}

Index run_table(const StudyTable& table, const RowSink& sink, const Monitor& monitor, Index first, LeadIn* lead_in) {
  const std::optional<Index> rows = rows_per_case(table);
  if (!rows && first > 0)
    throw Error(fmt::format("table {}: expected to start at row 0, met {}: its rows are not known beforehand",
                            table.name, first));
  const Index cases = varied_case_count(table), total = cases * rows.value_or(1);
  Index failed = 0;
  bool stopped = false;
  LeadIn own;
  LeadIn& states = lead_in == nullptr ? own : *lead_in;
  for (Index number = rows ? first / *rows : 0; number < cases && !stopped; ++number) {
    const auto [one, cells] = varied_case(table, number);
    const RowSink with_varied = [&sink, &varied = cells](const Row& row) {
      Row full = row;
      full.insert(full.begin() + 1, varied.begin(), varied.end());
      sink(full);
    };
    const Monitor within = [&](Index done, Index) {
      stopped = !report(monitor, number * *rows + done, total);
      return !stopped;
    };
    try {
      const Index known = rows ? std::max<Index>(first - number * *rows, 0) : 0;
      failed += table.observable->run({one, table, states, with_varied, within, known});
    } catch (const Error& error) {
      throw Error(fmt::format("case {}: {}", one.spec.name, error.what()));
    }
    if (!rows) stopped = !report(monitor, number + 1, total);
  }
  return failed;
}

}  // namespace nscdd
