// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>

namespace nscdd {

/// "a, b or c": the names of the values for which `right` holds, by default of all.
template <Named Enum, class Predicate = decltype([](Enum) { return true; })>
std::string names_where(const Predicate& right = {}) {
  std::vector<std::string_view> names;
  for (std::size_t k = 0; k < names_of(Enum{}).size(); ++k)
    if (right(static_cast<Enum>(k))) names.push_back(to_string(static_cast<Enum>(k)));
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text.append(k == 0 ? "" : k + 1 == names.size() ? " or " : ", ").append(names[k]);
  return text;
}

}  // namespace nscdd
