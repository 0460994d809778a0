// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <initializer_list>
#include <type_traits>
#include <variant>

namespace nscdd {

/// One value of a table. Every cell of a column holds the same alternative.
using Cell = std::variant<std::int64_t, double, bool, std::string>;

/// Heading of a table column; `unit` is an SI unit, "1" for a pure number and "" for a text.
struct Column {
  std::string name;
  std::string unit;
  std::string description;
};

using Row = std::vector<Cell>;

/// Results by named columns: what CSV and HDF5 files hold and what figures are drawn from.
struct Table {
  std::vector<Column> columns;
  std::vector<Row> rows;

  /// Position of the column of that name. Throws Error naming the existing columns.
  std::size_t column(const std::string& name) const;
};

/// Text of a cell in CSV: the shortest decimal that reads back to the same double (inf, -inf, nan), true or false.
std::string to_text(const Cell& cell);

/// Receives results one by one.
template <class Result>
using Sink = std::function<void(const Result&)>;
using RowSink = Sink<Row>;

/// A value as a cell: an integer, a number, a flag or a text; an enumeration by its `to_string`.
template <class Value>
Cell to_cell(const Value& value) {
  if constexpr (std::is_same_v<Value, bool> || std::is_same_v<Value, Cell>)
    return value;
  else if constexpr (std::is_integral_v<Value>)
    return static_cast<std::int64_t>(value);
  else if constexpr (std::is_floating_point_v<Value>)
    return double{value};
  else if constexpr (std::is_enum_v<Value>)
    return std::string(to_string(value));
  else
    return std::string(value);
}

/// A table column for results of one kind: its heading, and a getter that std::invoke takes with a Result.
template <class Result>
struct ResultColumn {
  Column heading;
  std::function<Cell(const Result&)> value;

  template <class Getter>
  ResultColumn(std::string name, std::string unit, std::string description, Getter getter)
      : heading{std::move(name), std::move(unit), std::move(description)},
        value([getter](const Result& result) { return to_cell(std::invoke(getter, result)); }) {}
};
template <class Result>
using ResultColumns = std::vector<ResultColumn<Result>>;

template <class Result>
std::vector<Column> headings(const ResultColumns<Result>& columns) {
  std::vector<Column> all;
  for (const ResultColumn<Result>& column : columns) all.push_back(column.heading);
  return all;
}

template <class Result>
Row row(const ResultColumns<Result>& columns, const Result& result) {
  Row cells;
  cells.reserve(columns.size());
  for (const ResultColumn<Result>& column : columns) cells.push_back(column.value(result));
  return cells;
}

/// A sink of results that forwards their rows to `sink`, which must outlive it.
template <class Result>
Sink<Result> as_rows(ResultColumns<Result> columns, const RowSink& sink) {
  return [columns = std::move(columns), &sink](const Result& result) { sink(row(columns, result)); };
}

/// The columns of a part of a larger result.
template <class Whole, class Part>
ResultColumns<Whole> columns_of(Part Whole::*part, const ResultColumns<Part>& columns) {
  ResultColumns<Whole> all;
  for (const auto& [heading, value] : columns)
    all.push_back({heading.name, heading.unit, heading.description,
                   [part, get = value](const Whole& whole) { return get(whole.*part); }});
  return all;
}

template <class Result>
ResultColumns<Result> joined(std::initializer_list<ResultColumns<Result>> lists) {
  ResultColumns<Result> all;
  for (const ResultColumns<Result>& columns : lists) all.insert(all.end(), columns.begin(), columns.end());
  return all;
}

/// Origin of a result file: pairs of a name and a text, such as ("command_line", "nscdd run ...").
using Provenance = std::vector<std::pair<std::string, std::string>>;

/// Version of this library, "major.minor.patch".
std::string version();

/// Fingerprint of the build, 16 hexadecimal digits, by sources, compiler and settings. Bits may differ between builds.
std::string build_fingerprint();

/// Name and version of every numerical library, in a fixed order.
Provenance dependency_versions();

}  // namespace nscdd
