// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>
#include <nscdd/core/components.hpp>

/// One description per parameter, used to read it from a file, list it, write it and override it.
/// A parameter struct P with defaults in place has
///     template <class Self, class Visitor> static void fields(Self& self, Visitor&& visit);
/// which calls visit(key, self.member, Field{...}) once per parameter. Members are double, Index, bool,
/// std::string, Choice<Enum>, Components<double> and Components<Index>, or a type with its own parse_value, field_text
/// and check_bounds, which is a text in TOML.
namespace nscdd {

struct Field {
  std::string_view description = {};
  std::string_view unit = "1";
  double minimum = -infinity;
  double above = -infinity;  ///< a bound that is excluded
  double maximum = infinity;
  double also = not_a_number;  ///< one allowed number outside the bounds, if any
};

/// A parameter as printed by `nscdd list` and recorded in result files.
struct FieldDescription {
  std::string key, type, value, unit, description;
  std::vector<std::string> words;  ///< the values of a Choice
};

/// Parses one number ("1e-3", "inf"). Throws Error naming `what` for any other text.
double parse_number(std::string_view text, std::string_view what);

/// Parses one integer. Throws Error naming `what` for any other text, or out of range.
Index parse_integer(std::string_view text, std::string_view what);

/// Sets a value from text: numbers as printed, pairs and components as "a,b" or "[a, b]". Throws Error naming `key`.
inline void parse_value(std::string_view text, double& value, std::string_view key) { value = parse_number(text, key); }
inline void parse_value(std::string_view text, Index& value, std::string_view key) { value = parse_integer(text, key); }
inline void parse_value(std::string_view text, std::string& value, std::string_view) { value = text; }
void parse_value(std::string_view text, bool& value, std::string_view key);

/// The two or three parts of "a,b", "a,b,c" or the like in brackets.
std::vector<std::string_view> components_of(std::string_view text, std::string_view key);
template <class Number>
void parse_value(std::string_view text, Components<Number>& value, std::string_view key) {
  std::array<Number, 3> numbers{};
  const std::vector<std::string_view> parts = components_of(text, key);
  for (std::size_t i = 0; i < parts.size(); ++i) parse_value(parts[i], numbers[i], key);
  value = {numbers, parts.size()};
}
template <Named Enum>
void parse_value(std::string_view text, Choice<Enum>& value, std::string_view key) {
  value = Choice<Enum>::parse(text, key);
}

/// Text that parse_value reads back, in TOML syntax.
std::string field_text(double value);
inline std::string field_text(Index value) { return std::to_string(value); }
inline std::string field_text(bool value) { return value ? "true" : "false"; }
std::string field_text(const std::string& value);
template <class Number>
std::string field_text(const Components<Number>& value) {
  std::string text;
  for (const Number component : value) text += (text.empty() ? "[" : ", ") + field_text(component);
  return text + "]";
}
template <Named Enum>
std::string field_text(Choice<Enum> value) {
  return field_text(std::string(to_string(value)));
}

template <class Value>
constexpr std::string_view field_type() {
  if (std::is_same_v<Value, double>) return "number";
  if (std::is_same_v<Value, Index>) return "integer";
  if (std::is_same_v<Value, bool>) return "boolean";
  if (std::is_same_v<Value, Components<double>>) return "two or three numbers";
  if (std::is_same_v<Value, Components<Index>>) return "two or three integers";
  return "text";
}

/// The names that a Choice accepts; none for any other type.
template <class Value>
std::vector<std::string> words_of(const Value&) {
  return {};
}
template <Named Enum>
std::vector<std::string> words_of(const Choice<Enum>&) {
  return all_names<Enum>();
}

/// Whether a number is finite and within the bounds of its field.
bool in_bounds(double value, const Field& field);

/// Throws Error unless every component of the value is in bounds or equals `Field::also`.
void check_bounds(double value, const Field& field, std::string_view key);
inline void check_bounds(Index value, const Field& field, std::string_view key) {
  check_bounds(static_cast<double>(value), field, key);
}
template <class Number>
void check_bounds(const Components<Number>& value, const Field& field, std::string_view key) {
  for (const Number component : value) check_bounds(component, field, key);
}
inline void check_bounds(bool, const Field&, std::string_view) {}
inline void check_bounds(const std::string&, const Field&, std::string_view) {}
template <Named Enum>
void check_bounds(Choice<Enum>, const Field&, std::string_view) {}

/// Throws Error naming "section.key" for a parameter of a section that is out of its bounds.
template <class Parameters>
void require_bounds(const Parameters& parameters, std::string_view section) {
  Parameters::fields(parameters, [&](std::string_view key, const auto& value, const Field& field) {
    check_bounds(value, field, std::string(section).append(".").append(key));
  });
}

/// Throws Error(key, "expected two numbers for a packing in the plane, met ...") for another number of components.
template <class Number>
void require_components(const Components<Number>& value, Index dimension, std::string_view key) {
  if (static_cast<Index>(value.size()) == dimension) return;
  const std::string numbers = std::is_same_v<Number, Index> ? " integers" : " numbers";
  throw Error(std::string(key), "expected " +
                                    (dimension == 2 ? "two" + numbers + " for a packing in the plane"
                                                    : "three" + numbers + " for a packing in space") +
                                    ", met " + field_text(value));
}

/// Every parameter of a struct with its present value.
template <class Parameters>
std::vector<FieldDescription> describe_fields(const Parameters& parameters) {
  std::vector<FieldDescription> all;
  Parameters::fields(parameters, [&]<class Value>(std::string_view key, const Value& value, const Field& field) {
    all.push_back({std::string(key), std::string(field_type<Value>()), field_text(value), std::string(field.unit),
                   std::string(field.description), words_of(value)});
  });
  return all;
}

/// Lines "key = value" of a parameter struct, in TOML syntax.
template <class Parameters>
std::string field_lines(const Parameters& parameters) {
  std::string lines;
  for (const FieldDescription& field : describe_fields(parameters)) lines += field.key + " = " + field.value + "\n";
  return lines;
}

/// Sets the parameter `key` from text and checks its bounds; false if there is no such key. `path`: its name in errors.
template <class Parameters>
bool override_field(Parameters& parameters, std::string_view key, std::string_view text, std::string_view path) {
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
