// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>

#include <string>
#include <string_view>

namespace nscdd {

/// A flexibility (eta, epsilon) as it is asked for: a number in 1/kg ("0.5"), or a multiple of the scale W of
/// the packing ("0.5 W"), the mean of the W_nn of its contacts. With masses m_i, m_j of the two grains of a
/// contact, W_nn = 1/m_i + 1/m_j, in 1/kg.
struct Flexibility {
  double value = 0;
  bool relative = false;

  /// In 1/kg, where the scale is known.
  double at_scale(double scale) const { return relative ? value * scale : value; }
  bool operator==(const Flexibility&) const = default;
};

/// Reads a number, with a W behind it or not. Throws Error naming `what` for anything else.
Flexibility parse_flexibility(std::string_view text, std::string_view what);

/// The flexibility of an enriched Stage 2 as a case has it: "optimal", or a number > 0.
class EtaChoice {
 public:
  EtaChoice() = default;
  EtaChoice(const char* text) : EtaChoice(std::string(text)) {}
  /// Throws Error naming `what` for a text that is neither.
  EtaChoice(const std::string& text, std::string_view what = "eta");

  bool optimal() const { return optimal_; }
  /// Of one that is not optimal.
  Flexibility flexibility() const { return flexibility_; }
  std::string text() const;
  bool operator==(const EtaChoice&) const = default;

 private:
  // Safe: see "Flexibilities relative to the packing" in docs/cases.md for what was measured.
  Flexibility flexibility_{10, true};
  bool optimal_ = false;
};

inline void parse_value(std::string_view text, EtaChoice& value, std::string_view key) {
  value = EtaChoice(std::string(text), key);
}
inline std::string field_text(const EtaChoice& value) { return field_text(value.text()); }
inline std::string_view field_type(const EtaChoice&) { return "text"; }
inline void check_bounds(const EtaChoice&, const Field&, std::string_view) {}

}  // namespace nscdd
