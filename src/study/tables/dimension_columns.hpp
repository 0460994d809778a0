// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>

namespace nscdd {

/// Whether a column holds numbers along z, by its name: z, z_a, normal_z and the like.
inline bool is_along_z(std::string_view name) { return name == "z" || name.starts_with("z_") || name.ends_with("_z"); }

/// The columns of a table of things in space as they are for bodies of a dimension: in the plane without those along z.
template <class Result>
ResultColumns<Result> in_dimension(ResultColumns<Result> columns, Index dimension) {
  if (dimension == 2) std::erase_if(columns, [](const auto& column) { return is_along_z(column.heading.name); });
  return columns;
}

}  // namespace nscdd
