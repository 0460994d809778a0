// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// A column of a packing file, whatever its format.
struct PackingColumn {
  std::vector<double> Packing::*values;
  bool required;
  std::string_view name;
  Field field;
};

/// The centre of a grain, in any direction.
inline constexpr Field packing_place{
    .description = "centre of the grain", .unit = "m", .minimum = -1e100, .maximum = 1e100};
constexpr Field packing_positive(std::string_view name, std::string_view unit) {
  return {.description = name, .unit = unit, .minimum = 0, .minimum_excluded = true, .maximum = 1e100};
}

inline constexpr PackingColumn packing_columns[] = {
    {&Packing::x, true, "x", packing_place},
    {&Packing::y, true, "y", packing_place},
    {&Packing::z, false, "z", packing_place},  // what has it is in space
    {&Packing::radius, true, "radius", packing_positive("radius", "m")},
    {&Packing::mass, false, "mass", packing_positive("mass", "kg")}};

/// The column of that name, which there is.
constexpr PackingColumn packing_column(std::string_view name) {
  return *std::ranges::find(packing_columns, name, &PackingColumn::name);
}

/// The number that a text of a packing file is. Throws Error "name:line: column: ..." for another text and for a number
/// out of its bounds.
double packing_value(std::string_view text, const PackingColumn& column, const std::string& name, std::size_t line);

}  // namespace nscdd
