// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <type_traits>
#include <variant>

/// Enumerations with names. The values of the enumeration count from 0; `names_of` lists their names:
///     enum class Colour { red, green };
///     constexpr auto names_of(Colour) { return std::to_array<std::string_view>({"red", "green"}); }
namespace nscdd {

template <class Enum>
concept Named = std::is_enum_v<Enum> && requires {
  std::span<const std::string_view>(names_of(Enum{}));
};

template <Named Enum>
constexpr std::string_view to_string(Enum value) {
  return names_of(value)[static_cast<std::size_t>(value)];
}

template <Named Enum>
std::vector<std::string> all_names() {
  const auto names = names_of(Enum{});
  return {names.begin(), names.end()};
}

/// "a, b or c": the names of the values for which `right` holds, by default of all.
template <Named Enum>
std::string names_where(const std::function<bool(Enum)>& right = {}) {
  std::vector<std::string_view> names;
  for (std::size_t k = 0; k < names_of(Enum{}).size(); ++k)
    if (!right || right(static_cast<Enum>(k))) names.push_back(to_string(static_cast<Enum>(k)));
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text.append(k == 0 ? "" : k + 1 == names.size() ? " or " : ", ").append(names[k]);
  return text;
}

/// Position of a name in a list. Throws Error "what: expected one of ..., met ..." for an unknown name.
std::size_t position_of(std::string_view name, std::span<const std::string_view> names, std::string_view what);

/// A parameter with named values, set by value or by name. An unknown name throws Error.
template <Named Enum>
class Choice {
 public:
  constexpr Choice(Enum value = {}) : value_(value) {}
  Choice(const char* name) : Choice(std::string(name)) {}
  Choice(const std::string& name) : value_(parse(name, "choice")) {}

  /// The value with that name. `what`: the key or option, for the error message.
  static Enum parse(std::string_view name, std::string_view what) {
    return static_cast<Enum>(position_of(name, names_of(Enum{}), what));
  }

  constexpr operator Enum() const { return value_; }
  friend constexpr bool operator==(Choice a, Choice b) { return a.value_ == b.value_; }
  friend constexpr bool operator==(Choice a, Enum b) { return a.value_ == b; }

 private:
  Enum value_;
};

template <Named Enum>
constexpr std::string_view to_string(Choice<Enum> choice) {
  return to_string(static_cast<Enum>(choice));
}

/// Names of the alternatives of a variant, each of which has a static member `name`.
template <class Variant>
struct Alternatives;
template <class... Types>
struct Alternatives<std::variant<Types...>> {
  static constexpr std::array<std::string_view, sizeof...(Types)> names{Types::name...};
  /// The alternative at a position, with its defaults.
  static std::variant<Types...> at(std::size_t position) {
    return std::array<std::variant<Types...>, sizeof...(Types)>{Types{}...}[position];
  }
};

/// "; did you mean NAME?" for the first known name that begins with `met`, else for the nearest by edit distance (swaps
/// count as one), or "" if none is near. `prefix` precedes the name.
std::string suggestion(std::string_view met, std::span<const std::string> known, std::string_view prefix = "");

}  // namespace nscdd
