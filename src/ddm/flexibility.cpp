// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/flexibility.hpp"

#include <nscdd/core/error.hpp>

#include <fmt/format.h>

namespace nscdd {

Flexibility parse_flexibility(std::string_view text, std::string_view what) {
  const bool relative = text.ends_with('W');
  return {parse_number(text.substr(0, text.size() - (relative ? 1 : 0)), what), relative};
}

EtaChoice::EtaChoice(const std::string& text, std::string_view what) : optimal_(text == "optimal") {
  if (optimal_) return;
  flexibility_ = parse_flexibility(text, what);
  check_bounds(flexibility_.value, Field{.description = "", .minimum = 0, .minimum_excluded = true}, what);
}

std::string EtaChoice::text() const {
  if (optimal_) return "optimal";
  return field_text(flexibility_.value) + (flexibility_.relative ? " W" : "");
}

}  // namespace nscdd
