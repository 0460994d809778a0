// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/moving_tables.hpp"
#include "study/network_tables.hpp"
#include "study/observed_rate.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>
#include <nscdd/study/optimum.hpp>
#include <nscdd/study/study.hpp>

#include <fmt/format.h>

namespace nscdd {
namespace {

std::vector<Column> observable_columns(const StudyTable& table) {
  switch (table.observable) {
    case Observable::spectral_radius:
      return sweep_columns(table.sweep.spectral);
    case Observable::optimum:
      return optimum_columns();
    case Observable::observed_rate:
      return observed_rate_columns();
    case Observable::links:
      return link_columns(table.sweep.contacts);
    case Observable::grains:
      return grain_columns();
    case Observable::indicators:
      return indicator_columns();
    case Observable::configuration:
      return configuration_columns();
    case Observable::force_chains:
      return chain_columns();
    case Observable::predicted_observed:
      return predicted_observed_columns();
    case Observable::runs:
      return run_columns();
  }
  return {};
}

// Rows per case, where they are known.
std::optional<Index> rows_per_case(const StudyTable& table) {
  switch (table.observable) {
    case Observable::spectral_radius:
    case Observable::observed_rate:
      return point_count(table.sweep);
    case Observable::optimum:
      return count(table.sweep.epsilon);
    case Observable::predicted_observed:
    case Observable::runs:
      return count(table.steps);
    case Observable::links:
    case Observable::grains:
    case Observable::indicators:
    case Observable::configuration:
    case Observable::force_chains:
      return std::nullopt;
  }
  return std::nullopt;
}

Index observe(const Model& model, const StudyTable& table, const RowSink& sink, const Monitor& monitor,
              Index first) {
  switch (table.observable) {
    case Observable::spectral_radius:
      return sweep(model, table.sweep, sink, monitor, first);
    case Observable::observed_rate:
      return observe(model, table.sweep, table.seed, sink, monitor, first);
    case Observable::links:
      link_rows(model, sink, table.sweep.contacts);
      return 0;
    case Observable::grains:
      grain_rows(model, sink);
      return 0;
    case Observable::optimum:
      return optima(model, table.sweep, sink, monitor, first);
    case Observable::indicators:
    case Observable::configuration:
    case Observable::force_chains:
    case Observable::predicted_observed:
    case Observable::runs:
      break;  // of cases that move: see observe_moving
  }
  return 0;
}

Index observe_moving(const Case& one, const StudyTable& table, LeadIn& lead_in, const RowSink& sink,
                     const Monitor& monitor, Index first) {
  Index failed = 0;
  for (Index k = first; k < count(table.steps); ++k) {
    const Index steps = table.steps[at(k)];
    const Place done{steps, table.lead_in}, before{steps - 1, table.lead_in};
    if (table.observable == Observable::configuration) configuration_rows(one, done, lead_in, sink);
    if (table.observable == Observable::force_chains) chain_rows(one, done, lead_in, sink);
    if (table.observable == Observable::indicators) indicator_rows(one, before, lead_in, sink);
    if (table.observable == Observable::predicted_observed)
      failed += !predicted_observed_row(one, before, lead_in, sink);
    if (table.observable == Observable::runs) run_row(one, steps, lead_in, sink);
    if (rows_per_case(table) && !report(monitor, k + 1, count(table.steps))) break;
  }
  return failed;
}

// A varied value as a cell: a number where it reads as one.
Cell as_cell(const std::string& value) {
  try {
    return parse_number(value, "value");
  } catch (const Error&) {
    return value;
  }
}

// Numbers where every value of the parameter is one, else texts: a column has one type.
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

bool moves(Observable observable) {
  return observable == Observable::indicators || observable == Observable::configuration ||
         observable == Observable::force_chains || observable == Observable::predicted_observed ||
         observable == Observable::runs;
}

std::vector<Column> study_columns(const StudyTable& table) {
  std::vector<Column> columns = observable_columns(table);
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

std::vector<std::pair<std::string, Cell>> known_cells(const StudyTable& table, Index row) {
  const auto rows = rows_per_case(table);
  if (!rows) return {};
  const Combination combination = combination_of(table, row / *rows);
  const Row varied = varied_cells(table, combination);
  const Index number = row % *rows;
  std::vector<std::pair<std::string, Cell>> cells{{"case", table.cases[at(combination.base)].name}};
  const std::vector<Variation> parameters = variations(table);
  for (std::size_t i = 0; i < varied.size(); ++i) cells.emplace_back(parameters[i].parameter, varied[i]);
  if (moves(table.observable)) {
    cells.emplace_back(table.observable == Observable::runs ? "steps" : "step",
                       std::int64_t{table.steps[at(number)]});
    return cells;
  }
  if (table.observable == Observable::optimum) {
    cells.emplace_back("epsilon", table.sweep.epsilon[at(number)]);
    return cells;
  }
  const SweepPoint point = sweep_point(table.sweep, number);
  cells.emplace_back("epsilon", point.epsilon);
  cells.emplace_back("eta", point.eta);
  if (point.relaxation) cells.emplace_back("relaxation", *point.relaxation);
  cells.emplace_back("gauss_seidel_sweeps",
                     point.gauss_seidel_sweeps ? static_cast<double>(*point.gauss_seidel_sweeps) : infinity);
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
    override_case(varied.one, parameters[i].parameter, parameters[i].values[at(combination.values[i])]);
  return varied;
}

Index run_table(const StudyTable& table, const RowSink& sink, const Monitor& monitor, Index first,
                LeadIn* lead_in) {
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
      failed += moves(table.observable) ? observe_moving(one, table, states, with_varied, within, known)
                                        : observe(build(one), table, with_varied, within, known);
    } catch (const Error& error) {
      throw Error(fmt::format("case {}: {}", one.name, error.what()));
    }
    if (!rows) stopped = !report(monitor, number + 1, total);
  }
  return failed;
}

}  // namespace nscdd
