// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// One description per parameter, used to read it from a file, list it, write it and override it.
/// A parameter struct P with defaults in place has
///     template <class Self, class Visitor> static void fields(Self& self, Visitor&& visit);
/// which calls visit(key, self.member, Field{...}) once per parameter. Members are double, Index,
/// bool, std::string, or pairs std::array<double, 2> and std::array<Index, 2>.
namespace nscdd {

struct Field {
  std::string_view description;
  std::string_view unit = "1";
  double minimum = -infinity;
  bool minimum_excluded = false;
  double maximum = infinity;
  double also = not_a_number;  ///< one more number that is allowed, outside the bounds; none where no number
  std::string_view choices = {};  ///< of a text: the values it may have, separated by blanks; empty for any
};

/// Names of the alternatives of a variant as choices of a field.
template <class Variant>
struct NamesOf;

template <class... Alternatives>
struct NamesOf<std::variant<Alternatives...>> {
  static constexpr auto characters = [] {
    std::array<char, ((Alternatives::name.size() + 1) + ...)> text{};
    std::size_t end = 0;
    const auto append = [&](std::string_view name) {
      for (const char letter : name) text[end++] = letter;
      text[end++] = ' ';
    };
    (append(Alternatives::name), ...);
    return text;
  }();
  static constexpr std::string_view value{characters.data(), characters.size() - 1};
};

/// A parameter as `nscdd list` shows it and as result files record it.
struct FieldDescription {
  std::string key, type, value, unit, description;
};

/// Reads a number in full ("1e-3", "inf"); throws Error naming `what` where the text is anything else.
double parse_number(std::string_view text, std::string_view what);

/// Reads an integer in full; throws Error naming `what` where the text is anything else or does not fit.
Index parse_integer(std::string_view text, std::string_view what);

/// Sets a value from text: numbers as printed, pairs as "a,b" or "[a, b]". Throws Error naming `key`.
void parse_value(std::string_view text, double& value, std::string_view key);
void parse_value(std::string_view text, Index& value, std::string_view key);
void parse_value(std::string_view text, bool& value, std::string_view key);
void parse_value(std::string_view text, std::string& value, std::string_view key);
void parse_value(std::string_view text, std::array<double, 2>& value, std::string_view key);
void parse_value(std::string_view text, std::array<Index, 2>& value, std::string_view key);

/// Text that parse_value reads back, in TOML syntax.
std::string field_text(double value);
std::string field_text(Index value);
std::string field_text(bool value);
std::string field_text(const std::string& value);
std::string field_text(const std::array<double, 2>& value);
std::string field_text(const std::array<Index, 2>& value);

std::string_view field_type(double);
std::string_view field_type(Index);
std::string_view field_type(bool);
std::string_view field_type(const std::string&);
std::string_view field_type(const std::array<double, 2>&);
std::string_view field_type(const std::array<Index, 2>&);

/// Throws Error unless every component of the value is finite and within the bounds of its field, or the text
/// is one of its choices.
void check_bounds(double value, const Field& field, std::string_view key);
void check_bounds(Index value, const Field& field, std::string_view key);
void check_bounds(const std::array<double, 2>& value, const Field& field, std::string_view key);
void check_bounds(const std::array<Index, 2>& value, const Field& field, std::string_view key);
inline void check_bounds(bool, const Field&, std::string_view) {}
void check_bounds(const std::string& value, const Field& field, std::string_view key);

/// Every parameter of a struct with its present value.
template <class Parameters>
std::vector<FieldDescription> describe_fields(const Parameters& parameters) {
  std::vector<FieldDescription> all;
  Parameters::fields(parameters, [&](std::string_view key, const auto& value, const Field& field) {
    all.push_back({std::string(key), std::string(field_type(value)), field_text(value),
                   std::string(field.unit), std::string(field.description)});
  });
  return all;
}

/// Lines "key = value" of a parameter struct, as a TOML file has them.
template <class Parameters>
std::string field_lines(const Parameters& parameters) {
  std::string lines;
  for (const FieldDescription& field : describe_fields(parameters))
    lines += field.key + " = " + field.value + "\n";
  return lines;
}

/// Sets the parameter `key` from text and checks its bounds; false where the struct has no such key.
/// `path` is the name for error messages, such as "packing.grains".
template <class Parameters>
bool override_field(Parameters& parameters, std::string_view key, std::string_view text,
                    std::string_view path) {
  bool found = false;
  Parameters::fields(parameters, [&](std::string_view name, auto& value, const Field& field) {
    if (name != key) return;
    parse_value(text, value, path);
    check_bounds(value, field, path);
    found = true;
  });
  return found;
}

}  // namespace nscdd
