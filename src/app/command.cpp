// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command.hpp"

#include "app/progress.hpp"
#include <nscdd/core/choice.hpp>
#include <nscdd/core/version.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>
#include <sstream>

namespace nscdd::app {
namespace {

void declare_all(CLI::App& command, const Command& described) {
  std::map<const Option*, CLI::Option*> made;
  for (const Option& option : described.options) {
    CLI::Option* one = made[&option] = std::visit(
        [&](auto* target) {
          if constexpr (std::is_same_v<decltype(target), bool*>)
            return command.add_flag(option.names, *target, option.help);
          else
            return command.add_option(option.names, *target, option.help);
        },
        option.target);
    one->required(option.required);
    if (!option.words.empty())
      one->check([words = option.words](std::string value) {
        const std::string refused = CLI::IsMember(words)(value);
        return refused.empty() ? refused : refused + suggestion(value, words);
      });
    if (option.bounds) one->check(CLI::Range(option.bounds->first, option.bounds->second));
    // A list takes one value each time it is named: what follows may be another argument.
    if (std::holds_alternative<std::vector<std::string>*>(option.target)) one->allow_extra_args(false);
    if (option.needs != nullptr) one->needs(made.at(option.needs));
    if (option.excludes != nullptr) one->excludes(made.at(option.excludes));
  }
}

// Throws Error for a verb or a long option that does not exist, naming the nearest one.
void check_names(const std::vector<DescribedVerb>& verbs, std::span<const char* const> arguments) {
  const std::string_view first = arguments.front();
  if (first.starts_with('-')) return;
  const auto verb = std::ranges::find(verbs, first, &DescribedVerb::name);
  if (verb == verbs.end()) {
    std::vector<std::string> known;
    for (const DescribedVerb& each : verbs) known.push_back(each.name);
    refuse("expected a verb ({}), met '{}'{}", fmt::join(known, ", "), first, suggestion(first, known));
  }
  const std::vector<std::string> known = verb->command.names();
  for (std::string_view argument : arguments.subspan(1)) {
    if (argument == "--") return;
    argument = argument.substr(0, argument.find('='));
    if (argument.starts_with("--") && std::ranges::find(known, argument) == known.end())
      refuse("expected an option of nscdd {}, met '{}'{}; 'nscdd {} --help' lists them", verb->name, argument,
             suggestion(argument, known), verb->name);
  }
}

}  // namespace

std::vector<std::string> Command::names() const {
  std::vector<std::string> all{"--help"};
  for (const Option& option : options) {
    if (option.positional()) continue;
    std::istringstream names(option.names);
    for (std::string name; std::getline(names, name, ',');) all.push_back(name);
  }
  return all;
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
  const auto asked = [&] {
    const auto found = std::ranges::find_if(commands, [](const CLI::App* command) { return command->parsed(); });
    return static_cast<std::size_t>(found - commands.begin());
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return asked() < verbs.size() ? help_screen(verbs[asked()]) : short_guide(verbs);
  } catch (const CLI::CallForVersion& version) {
    return std::string(version.what()) + "\n";
  } catch (const CLI::ParseError& error) {
    refuse("{}; 'nscdd --help' and 'nscdd VERB --help' say how", error.what());
  }
  return asked();
}

}  // namespace nscdd::app
