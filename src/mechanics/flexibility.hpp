// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>

namespace nscdd {

/// A flexibility: a number in 1/kg (0.5), or a multiple ("0.5 W") of W, the mean of the W_nn of all contacts, 1/kg.
struct Flexibility {
  static constexpr std::string_view expected =
      "a number in 1/kg such as 0.5, or a multiple of the mean of W_nn such as \"30 W\"";

  constexpr Flexibility(double number = 0, bool multiple = false) : value(number), relative(multiple) {}

  double value;
  bool relative;  ///< to W

  /// In 1/kg.
  double at_scale(double scale) const { return relative ? value * scale : value; }
  bool operator==(const Flexibility&) const = default;
};

/// Reads "0.5" or "0.5 W". Throws Error naming `key` and `expected` for any other text or a number out of bounds.
inline Flexibility parse_flexibility(std::string_view text, const Field& bounds, std::string_view key,
                                     std::string_view expected = Flexibility::expected) {
  const bool relative = text.ends_with('W');
  try {
    const double number = parse_number(text.substr(0, text.size() - (relative ? 1 : 0)), key);
    check_bounds(number, bounds, key);
    return {number, relative};
  } catch (const Error&) {
    throw Error(std::string(key) + ": expected " + std::string(expected) + ", met \"" + std::string(text) + "\"");
  }
}

inline void parse_value(std::string_view text, Flexibility& value, std::string_view key) {
  value = parse_flexibility(text, {}, key);
}
inline std::string field_text(const Flexibility& flexibility) {
  const std::string number = field_text(flexibility.value);
  return flexibility.relative ? field_text(number + " W") : number;
}
inline void check_bounds(const Flexibility& flexibility, const Field& field, std::string_view key) {
  check_bounds(flexibility.value, field, key);
}

}  // namespace nscdd
