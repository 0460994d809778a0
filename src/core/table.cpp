// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/core/table.hpp>

#include <fmt/format.h>

#include <cmath>

namespace nscdd {

std::size_t Table::column(const std::string& name) const {
  std::string known;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].name == name) return i;
    known += (i == 0 ? "" : ", ") + columns[i].name;
  }
  throw Error(fmt::format("expected a column '{}', met only: {}", name, known));
}

std::string to_text(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell); number != nullptr && std::isnan(*number))
    return "nan";  // whatever its sign bit
  return std::visit([](const auto& value) { return fmt::format("{}", value); }, cell);
}

}  // namespace nscdd
