// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include "core/text.hpp"
#include <nscdd/core/fields.hpp>

#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <set>

namespace nscdd {

/// Strict reader of a TOML table: every key must be read before `finish`, and every value must have the requested type
/// and bounds. Otherwise throws Error "file:line: key: expected ..., met ...".
class StrictTable {
 public:
  StrictTable(const toml::table& table, std::string file, std::string path)
      : table_(&table), file_(std::move(file)), path_(std::move(path)) {}

  std::string key_path(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
  }

  [[noreturn]] void fail(const toml::node* node, std::string_view key, std::string_view expected,
                         std::string_view met) const {
    nscdd::fail("{}: {}: expected {}, met {}", location(node), key_path(key), expected, met);
  }
  [[noreturn]] void fail(std::string_view key, std::string_view expected, std::string_view met) const {
    fail(table_->get(key), key, expected, met);
  }

  bool has(std::string_view key) const { return table_->contains(key); }

  const toml::node* node(std::string_view key) {
    known_.emplace(key);
    return table_->get(key);
  }

  /// A section [key]; a missing optional section is empty.
  StrictTable section(std::string_view key, bool required) {
    static const toml::table empty;
    const toml::node* found = node(key);
    if (found == nullptr) {
      if (required)
        nscdd::fail("{}: expected a section [{}], met none{}", location(nullptr), key_path(key), sections());
      return {empty, file_, key_path(key)};
    }
    if (!found->is_table()) fail(key, fmt::format("a section [{}]", key_path(key)), describe(*found));
    return {*found->as_table(), file_, key_path(key)};
  }

  /// "; sections here: [a], [b]" of a table that has any.
  std::string sections() const {
    std::string names;
    for (const auto& [key, value] : *table_)
      if (value.is_table()) names.append(names.empty() ? "; sections here: [" : ", [").append(key.str()).append("]");
    return names;
  }

  /// The tables [[key]]; none if the key is absent.
  std::vector<StrictTable> tables(std::string_view key) {
    std::vector<StrictTable> all;
    const toml::node* found = node(key);
    if (found == nullptr) return all;
    const toml::array* array = found->as_array();
    if (array == nullptr) fail(key, fmt::format("tables [[{}]]", key_path(key)), describe(*found));
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::node& element = (*array)[i];
      if (!element.is_table()) fail(&element, key, fmt::format("tables [[{}]]", key_path(key)), describe(element));
      all.emplace_back(*element.as_table(), file_, fmt::format("{}[{}]", key_path(key), i));
    }
    return all;
  }

  /// Sets `value` if the key exists. Values of types outside TOML, such as a Choice, are parsed from text.
  template <class Value>
  void read(std::string_view key, Value& value) {
    if (const toml::node* found = node(key)) get(*found, key, value);
  }
  /// Sets `value` within bounds if the key exists.
  void read(std::string_view key, auto& value, const Field& field) {
    read(key, value);
    check_bounds(value, field, where(key));
  }

  /// Throws for the first missing key.
  void require_keys(std::initializer_list<const char*> keys) const {
    for (const char* key : keys)
      if (!has(key)) fail(key, "a value", "none");
  }

  /// Runs `action` and prefixes its errors with the line of `key` and `what`.
  auto located(std::string_view key, auto&& action, std::string_view what = "") const {
    try {
      return action();
    } catch (const Error& error) {
      nscdd::fail("{}: {}{}", location(table_->get(key)), what, error.what());
    }
  }

  /// Reads every field of a parameter struct, with its bounds.
  template <class Parameters>
  void read_fields(Parameters& parameters) {
    Parameters::fields(parameters,
                       [&](std::string_view key, auto& value, const Field& field) { read(key, value, field); });
  }
  /// Reads an optional section with these fields only.
  template <class Parameters>
  StrictTable read_section(std::string_view key, Parameters& parameters) {
    StrictTable found = section(key, false);
    found.read_fields(parameters);
    found.finish();
    return found;
  }

  /// Throws for the first unread key.
  void finish() const {
    for (const auto& [key, value] : *table_) {
      if (known_.contains(std::string(key.str()))) continue;
      const std::vector<std::string> known(known_.begin(), known_.end());
      nscdd::fail("{}:{}: unknown key '{}'; expected {}{}{}", file_, key.source().begin.line, key_path(key.str()),
                  known.empty() ? "none" : "one of ", fmt::join(known, ", "), suggestion(key.str(), known));
    }
  }

  std::string location(const toml::node* found) const {
    const auto line = found != nullptr ? found->source().begin.line : table_->source().begin.line;
    return line > 0 ? fmt::format("{}:{}", file_, line) : file_;
  }

  /// "file:line: key", for errors thrown elsewhere.
  std::string where(std::string_view key) const {
    return fmt::format("{}: {}", location(table_->get(key)), key_path(key));
  }

  static std::string describe(const toml::node& found) {
    std::ostringstream text;
    text << std::boolalpha;
    found.visit([&](const auto& value) {
      if constexpr (toml::is_value<decltype(value)>) text << *value;
    });
    const std::string_view type = found.is_string()           ? "the text"
                                  : found.is_integer()        ? "the integer"
                                  : found.is_floating_point() ? "the number"
                                  : found.is_boolean()        ? "the boolean"
                                  : found.is_array()          ? "an array"
                                  : found.is_table()          ? "a section"
                                                              : "a date or time";
    return text.str().empty() ? std::string(type) : fmt::format("{} '{}'", type, text.str().substr(0, 80));
  }

 private:
  template <class Value>
  void get(const toml::node& found, std::string_view key, Value& value) const {
    const auto require = [&](bool holds, std::string_view expected) {
      if (!holds) fail(&found, key, expected, describe(found));
    };
    if constexpr (std::is_same_v<Value, double>) {
      require(found.is_number(), "a number");
      value = found.is_integer() ? static_cast<double>(**found.as_integer()) : **found.as_floating_point();
    } else if constexpr (std::is_same_v<Value, Index>) {
      require(found.is_integer(), "an integer");
      value = static_cast<Index>(**found.as_integer());
    } else if constexpr (std::is_same_v<Value, bool>) {
      require(found.is_boolean(), "true or false");
      value = **found.as_boolean();
    } else if constexpr (std::is_same_v<Value, std::string>) {
      require(found.is_string(), "a text");
      value = **found.as_string();
    } else {
      std::string text;
      double number = 0;
      if constexpr (requires { Value::expected; }) require(found.is_string() || found.is_number(), Value::expected);
      if (found.is_number() && requires { Value::expected; }) {
        get(found, key, number);
        text = field_text(number);
      } else {
        get(found, key, text);
      }
      parse_value(text, value, where(key));
    }
  }
  template <class Number>
  void get(const toml::node& found, std::string_view key, Components<Number>& value) const {
    const char* expected = std::is_same_v<Number, double> ? "two numbers [a, b], or three in space"
                                                          : "two integers [a, b], or three in space";
    const toml::array* array = found.as_array();
    if (array == nullptr) fail(key, expected, describe(found));
    if (array->size() != 2 && array->size() != 3) fail(key, expected, fmt::format("an array of {}", array->size()));
    std::array<Number, 3> numbers{};
    for (std::size_t i = 0; i < array->size(); ++i) get((*array)[i], key, numbers[i]);
    value = {numbers, array->size()};
  }

  const toml::table* table_;
  std::string file_, path_;
  std::set<std::string> known_;
};

/// Parses TOML text, with line ends as in TextLines; a syntax error becomes Error "file:line: ...".
inline toml::table parse_toml(std::string_view text, const std::string& file) {
  require_utf8(text, file);
  std::string content(text);
  std::ranges::replace(content, line_end_of(content), '\n');
  try {
    return toml::parse(content, file);
  } catch (const toml::parse_error& error) {
    fail("{}:{}: not valid TOML: {}", file, error.source().begin.line, error.description());
  }
}

}  // namespace nscdd
