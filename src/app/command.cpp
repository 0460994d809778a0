// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command.hpp"

#include "app/manual.hpp"
#include <nscdd/core/choice.hpp>
#include <nscdd/core/error.hpp>
#include <nscdd/core/version.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>

namespace nscdd::app {
namespace {

CLI::Option* declare(CLI::App& command, const Option& option) {
  return std::visit(
      [&](auto* target) {
        if constexpr (std::is_same_v<decltype(target), bool*>)
          return command.add_flag(option.names(), *target, option.help());
        else
          return command.add_option(option.names(), *target, option.help());
      },
      option.target());
}

void declare_all(CLI::App& command, const Command& described) {
  std::map<const Option*, CLI::Option*> made;
  for (const Option& option : described.options()) {
    CLI::Option* one = made[&option] = declare(command, option);
    one->required(option.is_required());
    if (!option.words().empty())
      one->check([words = option.words()](std::string value) {
        const std::string refused = CLI::IsMember(words)(value);
        return refused.empty() ? refused : refused + suggestion(value, words);
      });
    if (option.bounds()) one->check(CLI::Range(option.bounds()->first, option.bounds()->second));
    if (option.has_default()) one->capture_default_str();
    // A list takes one value each time it is named: what follows may be another argument.
    if (std::holds_alternative<std::vector<std::string>*>(option.target())) one->allow_extra_args(false);
    for (const Option* other : option.needed()) one->needs(made.at(other));
    for (const Option* other : option.excluded()) one->excludes(made.at(other));
  }
}

// "-o,--output" as "-o" and "--output".
void add_names(const std::string& names, std::vector<std::string>& all) {
  for (std::size_t begin = 0; begin < names.size();) {
    const std::size_t end = std::min(names.find(',', begin), names.size());
    all.push_back(names.substr(begin, end - begin));
    begin = end + 1;
  }
}

// Throws Error for a verb or a long option that does not exist, naming the nearest one.
void check_names(const std::vector<DescribedVerb>& verbs, std::span<const char* const> arguments) {
  const std::string_view first = arguments.front();
  if (first.starts_with('-')) return;
  std::vector<std::string> names;
  for (const DescribedVerb& verb : verbs) names.push_back(verb.name);
  const auto found = std::find(names.begin(), names.end(), first);
  if (found == names.end())
    throw Error(
        fmt::format("expected a verb ({}), met '{}'{}", fmt::join(names, ", "), first, suggestion(first, names)));
  const DescribedVerb& verb = verbs[static_cast<std::size_t>(found - names.begin())];
  names = {"--help"};
  for (const Option& option : verb.command.options()) add_names(option.names(), names);
  for (std::string_view argument : arguments.subspan(1)) {
    if (argument == "--") return;
    argument = argument.substr(0, argument.find('='));
    if (argument.starts_with("--") && std::find(names.begin(), names.end(), argument) == names.end())
      throw Error(fmt::format("expected an option of nscdd {}, met '{}'{}; 'nscdd {} --help' lists them", verb.name,
                              argument, suggestion(argument, names), verb.name));
  }
}

}  // namespace

Option* Option::required() {
  required_ = true;
  return this;
}

Option* Option::shows_default() {
  shows_default_ = true;
  return this;
}

Option* Option::one_of(std::vector<std::string> words) {
  words_ = std::move(words);
  return this;
}

Option* Option::between(Index smallest, Index largest) {
  bounds_ = {smallest, largest};
  return this;
}

Option* Option::needs(const Option* other) {
  needed_.push_back(other);
  return this;
}

Option* Option::excludes(const Option* other) {
  excluded_.push_back(other);
  return this;
}

Option* Command::add_option(std::string names, Option::Target target, std::string help) {
  return &options_.emplace_back(std::move(names), target, std::move(help));
}

Option* Command::add_flag(std::string names, bool& target, std::string help) {
  return add_option(std::move(names), Option::Target(&target), std::move(help));
}

Request parse_command_line(const std::vector<DescribedVerb>& verbs, int argc, const char* const* argv) {
  if (argc <= 1) return short_guide(verbs);
  check_names(verbs, std::span(argv, static_cast<std::size_t>(argc)).subspan(1));
  CLI::App app("", "nscdd");
  app.set_version_flag("--version", "nscdd " + version());
  app.require_subcommand(1);
  std::vector<CLI::App*> commands;
  for (const DescribedVerb& verb : verbs) {
    commands.push_back(app.add_subcommand(verb.name, verb.summary));
    declare_all(*commands.back(), verb.command);
  }
  const auto asked = [&]() -> std::size_t {
    std::size_t i = 0;
    while (i < verbs.size() && !commands[i]->parsed()) ++i;
    return i;
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return asked() < verbs.size() ? help_screen(verbs[asked()]) : short_guide(verbs);
  } catch (const CLI::CallForVersion& version) {
    return std::string(version.what()) + "\n";
  } catch (const CLI::ParseError& error) {
    throw Error(fmt::format("{}; 'nscdd --help' and 'nscdd VERB --help' say how", error.what()));
  }
  return asked();
}

}  // namespace nscdd::app
