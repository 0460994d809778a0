// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command.hpp"

#include "core/fail.hpp"

namespace nscdd::app {
namespace {

void give(Option& option, std::string_view name, std::optional<std::string_view> value) {
  if (option.given && !option.list) fail("{}: expected it once, met it again", name);
  if (option.flag && value) fail("{}: expected no value, met '{}'", name, *value);
  if (!option.flag && !value) fail("{}: expected a value, met none", name);
  if (value && value->empty()) fail("{}: expected a value, met an empty text", name);
  if (!option.words.empty())
    position_of(*value, std::vector<std::string_view>(option.words.begin(), option.words.end()), name);
  option.set(value.value_or("true"), name);
  option.given = true;
}

void check_given(const Command& command) {
  for (const Option& option : command.options) {
    const std::string name = option.spellings().back();
    if (option.required && !option.given) fail("expected {}, met none", name);
    if (!option.given) continue;
    if (option.needs != nullptr && !option.needs->given)
      fail("{}: expected {} with it, met none", name, option.needs->spellings().back());
    if (option.excludes != nullptr && option.excludes->given)
      fail("{0}: expected no {1} with it, met {1}", name, option.excludes->spellings().back());
  }
}

}  // namespace

std::vector<std::string> Option::spellings() const {
  const auto comma = names.find(',');
  if (comma == names.npos) return {names};
  return {names.substr(0, comma), names.substr(comma + 1)};
}

std::vector<std::string> Command::names() const {
  std::vector<std::string> all{"--help"};
  for (const Option& option : options)
    if (!option.positional()) std::ranges::copy(option.spellings(), std::back_inserter(all));
  return all;
}

Option& Command::named(std::string_view name) {
  for (Option& option : options)
    if (!option.positional() && std::ranges::count(option.spellings(), name) > 0) return option;
  fail("expected a known option, met '{}'{}", name, suggestion(name, names()));
}

void parse(Command& command, std::span<const char* const> arguments) {
  auto place = command.options.begin();  // of the next positional argument
  bool options_end = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view argument = arguments[i];
    if (options_end || argument.size() < 2 || argument.front() != '-') {
      place = std::find_if(place, command.options.end(), [](const Option& one) { return one.positional(); });
      if (place == command.options.end()) fail("expected no further argument, met '{}'", argument);
      give(*place, place->names, argument);
      ++place;
    } else if (argument == "--") {
      options_end = true;
    } else {
      // "--output FILE", "--output=FILE", "-o FILE" or "-oFILE"
      const bool whole_word = argument.starts_with("--");
      const std::size_t end = whole_word ? std::min(argument.find('='), argument.size()) : 2;
      const std::string_view name = argument.substr(0, end);
      Option& option = command.named(name);
      std::optional<std::string_view> value;
      if (end < argument.size())
        value = argument.substr(whole_word ? end + 1 : end);
      else if (!option.flag && i + 1 < arguments.size() && !std::string_view(arguments[i + 1]).starts_with("--"))
        value = arguments[++i];
      give(option, name, value);
    }
  }
  check_given(command);
}

}  // namespace nscdd::app
