// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>
#include <nscdd/io/csv.hpp>
#include <nscdd/io/packing_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace nscdd {
namespace {

struct PackingColumn {
  std::string_view name;
  std::vector<double> Packing::*values;
  Field field;
  bool required;
};

const std::array<PackingColumn, 4>& packing_columns() {
  static const std::array<PackingColumn, 4> columns{{
      {"x", &Packing::x, {.description = "centre", .unit = "m", .minimum = -1e100, .maximum = 1e100}, true},
      {"y", &Packing::y, {.description = "centre", .unit = "m", .minimum = -1e100, .maximum = 1e100}, true},
      {"radius",
       &Packing::radius,
       {.description = "radius", .unit = "m", .minimum = 0, .minimum_excluded = true, .maximum = 1e100},
       true},
      {"mass",
       &Packing::mass,
       {.description = "mass", .unit = "kg", .minimum = 0, .minimum_excluded = true, .maximum = 1e100},
       false},
  }};
  return columns;
}

}  // namespace

Packing parse_packing(std::string_view text, const std::string& name) {
  const CsvText csv = parse_csv(text, name);
  std::vector<const PackingColumn*> meaning;
  for (const std::string& column : csv.columns) {
    const PackingColumn* found = nullptr;
    for (const PackingColumn& known : packing_columns())
      if (known.name == column) found = &known;
    if (found == nullptr)
      throw Error(fmt::format("{}:{}: expected columns x, y, radius and optionally mass, met '{}'", name,
                              csv.header_line, column));
    meaning.push_back(found);
  }
  for (const PackingColumn& known : packing_columns())
    if (known.required && std::find(meaning.begin(), meaning.end(), &known) == meaning.end())
      throw Error(fmt::format("{}:{}: expected a column '{}', met none", name, csv.header_line, known.name));
  Packing packing;
  for (std::size_t row = 0; row < csv.rows.size(); ++row)
    for (std::size_t j = 0; j < meaning.size(); ++j) {
      const std::string where = fmt::format("{}:{}: {}", name, csv.lines[row], meaning[j]->name);
      const double value = parse_number(csv.rows[row][j], where);
      check_bounds(value, meaning[j]->field, where);
      (packing.*(meaning[j]->values)).push_back(value);
    }
  if (packing.size() == 0) throw Error(fmt::format("{}: expected at least one grain, met none", name));
  return packing;
}

Packing read_packing(const std::string& path) { return parse_packing(read_text(path), path); }

}  // namespace nscdd
