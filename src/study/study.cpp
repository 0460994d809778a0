// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>
#include <nscdd/study/network_tables.hpp>
#include <nscdd/study/observed_rate.hpp>
#include <nscdd/study/optimum.hpp>
#include <nscdd/study/study.hpp>

#include <fmt/format.h>

namespace nscdd {
namespace {

std::vector<Column> observable_columns(const StudyTable& table) {
  switch (table.observable) {
    case Observable::spectral_radius:
      return sweep_columns();
    case Observable::optimum:
      return optimum_columns();
    case Observable::observed_rate:
      return observed_rate_columns();
    case Observable::links:
      return link_columns(table.sweep.contacts);
    case Observable::grains:
      return grain_columns();
  }
  return {};
}

Index observe(const Model& model, const StudyTable& table, const RowSink& sink, const Monitor& monitor) {
  Index failed = 0;
  switch (table.observable) {
    case Observable::spectral_radius:
      return sweep(model, table.sweep, sink, monitor);
    case Observable::observed_rate:
      return observe(model, table.sweep, table.seed, sink, monitor);
    case Observable::links:
      link_rows(model, sink, table.sweep.contacts);
      return 0;
    case Observable::grains:
      grain_rows(model, sink);
      return 0;
    case Observable::optimum:
      for (const double epsilon : table.sweep.epsilon) {
        const OptimumParameters parameters{epsilon, table.sweep.contacts, table.sweep.spectral};
        const Optimum best = optimum(model, parameters);
        failed += best.status == OptimumStatus::not_converged;
        sink(optimum_row(model, parameters, best));
      }
      return failed;
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

}  // namespace

std::vector<Column> study_columns(const StudyTable& table) {
  std::vector<Column> columns = observable_columns(table);
  std::vector<Column> varied;
  for (const Variation& variation : table.vary)
    varied.push_back({variation.parameter, "", "parameter of the case, varied by the study"});
  columns.insert(columns.begin() + 1, varied.begin(), varied.end());
  return columns;
}

Index run_table(const StudyTable& table, const RowSink& sink, const Monitor& monitor) {
  std::size_t combinations = 1;
  for (const Variation& variation : table.vary) combinations *= variation.values.size();
  const auto total = static_cast<Index>(combinations * table.cases.size());
  Index done = 0, failed = 0;
  for (const Case& base : table.cases)
    for (std::size_t combination = 0; combination < combinations; ++combination) {
      Case one = base;
      Row varied;
      std::size_t rest = combination, stride = combinations;
      for (const Variation& variation : table.vary) {
        stride /= variation.values.size();
        const std::size_t k = rest / stride;
        rest %= stride;
        override_case(one, variation.parameter, variation.values[k]);
        varied.push_back(as_cells(variation.values)[k]);
      }
      const RowSink with_varied = [&](const Row& row) {
        Row full = row;
        full.insert(full.begin() + 1, varied.begin(), varied.end());
        sink(full);
      };
      const Monitor within = [&](Index part, Index parts) {
        return report(monitor, done * 1000 + 1000 * part / std::max<Index>(parts, 1), total * 1000);
      };
      try {
        failed += observe(build(one), table, with_varied, within);
      } catch (const Error& error) {
        throw Error(fmt::format("case {}: {}", one.name, error.what()));
      }
      if (!report(monitor, ++done * 1000, total * 1000)) return failed;
    }
  return failed;
}

}  // namespace nscdd
