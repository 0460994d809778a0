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

// A varied value as a cell: a number if it reads as one, else a text.
Cell as_cell(const std::string& value) {
  try {
    return parse_number(value, "value");
  } catch (const Error&) {
    return value;
  }
}

// A column has one type: numbers if every value of the parameter is a number, else texts.
std::vector<Cell> as_cells(const std::vector<std::string>& values) {
  std::vector<Cell> cells;
  for (const std::string& value : values) cells.push_back(as_cell(value));
  for (const Cell& cell : cells)
    if (!std::holds_alternative<double>(cell)) return {values.begin(), values.end()};
  return cells;
}

// The parameters of both kinds in the order of their columns.
std::vector<Variation> variations(const StudyTable& table) {
  std::vector<Variation> all = table.vary_together;
  all.insert(all.end(), table.vary.begin(), table.vary.end());
  return all;
}

// Places in the lists of the parameters that change at once.
Index places_together(const StudyTable& table) {
  return table.vary_together.empty() ? 1 : count(table.vary_together[0].values);
}

// Which of the cases, and which value of each of the `variations`.
struct Combination {
  Index base = 0;
  std::vector<Index> values;
};

Combination combination_of(const StudyTable& table, Index number) {
  Index stride = varied_case_count(table) / count(table.cases);
  Combination combination{number / stride, {}};
  Index rest = number % stride;
  stride /= places_together(table);
  combination.values.assign(table.vary_together.size(), rest / stride);
  rest %= stride;
  for (const Variation& variation : table.vary) {
    stride /= count(variation.values);
    combination.values.push_back(rest / stride);
    rest %= stride;
  }
  return combination;
}

Row varied_cells(const StudyTable& table, const Combination& combination) {
  Row cells;
  const std::vector<Variation> varied = variations(table);
  for (std::size_t i = 0; i < varied.size(); ++i)
    cells.push_back(as_cells(varied[i].values)[at(combination.values[i])]);
  return cells;
}

}  // namespace

std::vector<Column> study_columns(const StudyTable& table) {
  std::vector<Column> columns = table.observable->columns(table);
  std::vector<Column> varied;
  for (const Variation& variation : variations(table))
    varied.push_back({variation.parameter, "", "parameter of the case, varied by the study"});
  columns.insert(columns.begin() + 1, varied.begin(), varied.end());
  return columns;
}

std::optional<Index> row_count(const StudyTable& table) {
  const auto rows = rows_per_case(table);
  if (!rows) return std::nullopt;
  return *rows * varied_case_count(table);
}

KnownCells known_cells(const StudyTable& table, Index row) {
  const auto rows = rows_per_case(table);
  if (!rows) return {};
  const Combination combination = combination_of(table, row / *rows);
  const Row varied = varied_cells(table, combination);
  KnownCells cells{{"case", table.cases[at(combination.base)].spec.name}};
  const std::vector<Variation> parameters = variations(table);
  for (std::size_t i = 0; i < varied.size(); ++i) cells.emplace_back(parameters[i].parameter, varied[i]);
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
  const Combination combination = combination_of(table, number);
  VariedCase varied{table.cases[at(combination.base)], varied_cells(table, combination)};
  const std::vector<Variation> parameters = variations(table);
  for (std::size_t i = 0; i < parameters.size(); ++i)
    override_case(varied.one.spec, parameters[i].parameter, parameters[i].values[at(combination.values[i])]);
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
