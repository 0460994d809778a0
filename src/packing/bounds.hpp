// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include "core/text.hpp"
#include <nscdd/core/fields.hpp>

namespace nscdd {

/// Throws Error naming the key for a parameter of a section that is out of its bounds.
template <class Parameters>
void require_bounds(const Parameters& parameters, std::string_view section) {
  Parameters::fields(parameters, [&](std::string_view key, const auto& value, const Field& field) {
    check_bounds(value, field, fmt::format("{}.{}", section, key));
  });
}

}  // namespace nscdd
