// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include <nscdd/ddm/partitioner.hpp>

namespace nscdd {

Partitioner parse_partitioner(std::string_view text, std::string_view what) {
  std::optional<Partitioner> found;
  std::string forms;
  for_each_partitioner([&](auto one) {
    forms += fmt::format("{}{}", forms.empty() ? "" : ", or ", one.option_form);
    if (const auto colon = text.find(':'); colon < text.size() && text.substr(0, colon) != one.name) return;
    const std::optional<std::string> value = one.value_of_option(text);
    if (!value || found) return;
    override_field(one, one.name, *value, what);
    found = one;
  });
  if (!found) fail("{}: expected {}, met '{}'", what, forms, text);
  return *found;
}

}  // namespace nscdd
