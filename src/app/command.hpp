// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

#include <deque>

namespace nscdd::app {

/// An option of a verb. The parser, the help, the manual pages and the completion of the shell read this description.
struct Option {
  std::string names;  ///< "-o,--output", or "CASE" for an argument by its position
  std::string help;
  std::string value = {};  ///< placeholder of its value in the help, such as FILE
  bool flag = false;       ///< takes no value
  bool list = false;       ///< may be repeated
  /// Sets the target from a text. Throws Error naming the option for a text that is no value or is out of bounds.
  std::function<void(std::string_view text, std::string_view name)> set = {};
  bool required = false;
  std::string initial = {};             ///< default that the help shows; may be empty
  std::vector<std::string> words = {};  ///< the only accepted values, unless empty
  const Option* needs = nullptr;        ///< refused without this option
  const Option* excludes = nullptr;     ///< refused with this option
  bool given = false;                   ///< on the command line

  bool positional() const { return names.front() != '-'; }
  std::vector<std::string> spellings() const;  ///< "-o" and "--output"
};

/// Converts the text of an option and stores it in `value`.
template <class Value>
void take(std::string_view text, Value& value, std::string_view name, const Field& field) {
  parse_value(text, value, name);
  check_bounds(value, field, name);
}
template <class Value>
void take(std::string_view text, std::optional<Value>& value, std::string_view name, const Field& field) {
  take(text, value.emplace(), name, field);
}
inline void take(std::string_view text, std::vector<std::string>& values, std::string_view, const Field&) {
  values.emplace_back(text);
}

/// A value as the help shows it.
template <class Value>
std::string shown(const Value& value) {
  if constexpr (requires { to_string(value); })
    return std::string(to_string(value));
  else
    return fmt::format("{}", value);
}

/// The options of one verb, in the order of its help.
struct Command {
  std::deque<Option> options;  // addresses stay valid: options point to each other
  std::string footer;          ///< remarks and examples below the options

  /// `form`: names and, after a blank, the placeholder of the value, "-o,--output FILE". A bool is a flag.
  template <class Value>
  Option& add(const std::string& form, Value& value, std::string help, const Field& bounds = {}) {
    constexpr bool integer = std::is_same_v<Value, Index> || std::is_same_v<Value, std::optional<Index>>;
    constexpr bool number = std::is_same_v<Value, double> || std::is_same_v<Value, std::optional<double>>;
    const auto blank = std::min(form.find(' '), form.size());
    Option& option = options.emplace_back(Option{.names = form.substr(0, blank), .help = std::move(help)});
    option.value = blank < form.size() ? form.substr(blank + 1) : integer ? "N" : number ? "NUMBER" : "TEXT";
    option.flag = std::is_same_v<Value, bool>;
    option.list = std::is_same_v<Value, std::vector<std::string>>;
    option.set = [&value, bounds](std::string_view text, std::string_view name) { take(text, value, name, bounds); };
    option.words = words_of(value);
    return option;
  }
  template <class Value>
  void required(const std::string& form, Value& value, std::string help) {
    add(form, value, std::move(help)).required = true;
  }
  /// An option whose help shows its default.
  template <class Value>
  Option& preset(const std::string& form, Value& value, std::string help, const Field& bounds = {}) {
    Option& option = add(form, value, std::move(help), bounds);
    option.initial = shown(value);
    return option;
  }
  /// An option --like-this for each parameter like_this of a struct (core/fields.hpp), except those in `without`.
  template <class Parameters>
  void fields(Parameters& parameters, std::initializer_list<std::string_view> without = {}) {
    Parameters::fields(parameters, [&]<class Value>(std::string_view key, Value& value, const Field& field) {
      if (std::ranges::find(without, key) != without.end()) return;
      std::string name = "--" + std::string(key);
      std::ranges::replace(name, '_', '-');
      Option& option = add(name, value, std::string(field.description), field);
      if (!option.flag) option.initial = shown(value);
    });
  }

  Option& named(std::string_view name);    ///< "--output" or "-o"; throws Error with the nearest name if there is none
  std::vector<std::string> names() const;  ///< "--help" and all names of options
};

/// Sets the targets of the options in `arguments`. Throws Error for arguments that do not fit the description.
void parse(Command& command, std::span<const char* const> arguments);

}  // namespace nscdd::app
