// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

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

  /// Position of the column of that name; throws Error naming the columns there are.
  std::size_t column(const std::string& name) const;
};

/// Text of a cell as written to CSV: the shortest decimal that reads back to the same double
/// (inf, -inf, nan for the special values), true/false for a bool.
std::string to_text(const Cell& cell);

}  // namespace nscdd
