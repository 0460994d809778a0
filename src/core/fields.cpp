// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace nscdd {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

template <class Number>
Number parse_all(std::string_view text, std::string_view what, std::string_view expected) {
  text = trimmed(text);
  Number value{};
  const bool plus = text.size() > 1 && text.front() == '+' && text[1] != '-';
  const char* first = text.data() + (plus ? 1 : 0);
  const char* last = text.data() + text.size();
  const auto [end, status] = std::from_chars(first, last, value);
  if (status == std::errc::result_out_of_range)
    throw Error(fmt::format("{}: expected {}, met '{}', which is out of range", what, expected, text));
  if (text.empty() || status != std::errc() || end != last)
    throw Error(fmt::format("{}: expected {}, met '{}'", what, expected, text));
  return value;
}

template <class Number>
void parse_pair(std::string_view text, std::array<Number, 2>& value, std::string_view key) {
  std::string_view body = trimmed(text);
  if (body.size() >= 2 && body.front() == '[' && body.back() == ']') body = body.substr(1, body.size() - 2);
  const auto comma = body.find(',');
  if (comma == std::string_view::npos) throw Error(fmt::format("{}: expected two numbers 'a,b', met '{}'", key, text));
  parse_value(body.substr(0, comma), value[0], key);
  parse_value(body.substr(comma + 1), value[1], key);
}

}  // namespace

double parse_number(std::string_view text, std::string_view what) { return parse_all<double>(text, what, "a number"); }

Index parse_integer(std::string_view text, std::string_view what) { return parse_all<Index>(text, what, "an integer"); }

void parse_value(std::string_view text, double& value, std::string_view key) { value = parse_number(text, key); }
void parse_value(std::string_view text, Index& value, std::string_view key) { value = parse_integer(text, key); }
void parse_value(std::string_view text, std::string& value, std::string_view) { value = text; }
void parse_value(std::string_view text, bool& value, std::string_view key) {
  if (text != "true" && text != "false") throw Error(fmt::format("{}: expected true or false, met '{}'", key, text));
  value = text == "true";
}
void parse_value(std::string_view text, std::array<double, 2>& value, std::string_view key) {
  parse_pair(text, value, key);
}
void parse_value(std::string_view text, std::array<Index, 2>& value, std::string_view key) {
  parse_pair(text, value, key);
}

std::string field_text(double value) {
  const std::string text = fmt::format("{}", value);
  return text == "-0" ? "-0.0" : text;  // an integer has no -0
}
std::string field_text(Index value) { return fmt::format("{}", value); }
std::string field_text(bool value) { return value ? "true" : "false"; }
std::string field_text(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    if (const auto code = static_cast<unsigned char>(c); code < 0x20 || code == 0x7f) {
      text += fmt::format("\\u{:04X}", code);  // no control character stands for itself in TOML
    } else {
      text += c;
    }
  }
  return text + "\"";
}
std::string field_text(const std::array<double, 2>& value) {
  return fmt::format("[{}, {}]", field_text(value[0]), field_text(value[1]));
}
std::string field_text(const std::array<Index, 2>& value) { return fmt::format("[{}, {}]", value[0], value[1]); }

std::string_view field_type(double) { return "number"; }
std::string_view field_type(Index) { return "integer"; }
std::string_view field_type(bool) { return "boolean"; }
std::string_view field_type(const std::string&) { return "text"; }
std::string_view field_type(const std::array<double, 2>&) { return "pair of numbers"; }
std::string_view field_type(const std::array<Index, 2>&) { return "pair of integers"; }

void check_bounds(double value, const Field& field, std::string_view key) {
  const bool low = field.minimum_excluded ? value <= field.minimum : value < field.minimum;
  if ((std::isfinite(value) && !low && value <= field.maximum) || value == field.also) return;
  std::string expected = "a finite number";
  if (field.minimum > -infinity) expected += fmt::format(" {} {}", field.minimum_excluded ? ">" : ">=", field.minimum);
  if (field.maximum < infinity)
    expected += fmt::format("{} <= {}", field.minimum > -infinity ? " and" : "", field.maximum);
  if (!std::isnan(field.also)) expected += fmt::format(", or {}", field.also);
  throw Error(fmt::format("{}: expected {}, met {}", key, expected, value));
}
void check_bounds(Index value, const Field& field, std::string_view key) {
  check_bounds(static_cast<double>(value), field, key);
}
void check_bounds(const std::array<double, 2>& value, const Field& field, std::string_view key) {
  for (const double component : value) check_bounds(component, field, key);
}
void check_bounds(const std::array<Index, 2>& value, const Field& field, std::string_view key) {
  for (const Index component : value) check_bounds(component, field, key);
}

}  // namespace nscdd
