// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace nscdd::app {

/// An option of a verb, described once: the command line is parsed by it, and help, manual pages and the
/// completion of the shell are made from it.
struct Option {
  /// Where the value goes. An empty optional stays empty, and a list stays as it is, where the option is not
  /// given; a bool makes the option a flag.
  using Target = std::variant<std::string*, double*, Index*, bool*, std::optional<std::string>*, std::optional<double>*,
                              std::optional<Index>*, std::vector<std::string>*>;

  std::string names;  ///< "-o,--output", or "CASE" where it has no name
  Target target;
  std::string help;
  bool required = false;
  bool shows_default = false;           ///< the help prints the value that the target has now
  std::vector<std::string> words = {};  ///< the only values that are accepted, unless empty
  std::optional<std::pair<Index, Index>> bounds = {};
  const Option* needs = nullptr;  ///< refused without the other one
  const Option* excludes = nullptr;

  bool positional() const { return names.front() != '-'; }
  bool flag() const { return std::holds_alternative<bool*>(target); }
};

/// The options of one verb, in the order of its help.
struct Command {
  std::deque<Option> options;  // addresses stay: options name each other
  std::string footer;          ///< remarks and examples below the options

  template <class Value>
  Option& add(std::string names, Value& value, std::string help) {
    return options.emplace_back(Option{std::move(names), &value, std::move(help)});
  }
  template <class Value>
  Option& add_required(std::string names, Value& value, std::string help) {
    Option& option = add(std::move(names), value, std::move(help));
    option.required = true;
    return option;
  }
  template <class Value>
  Option& add_with_default(std::string names, Value& value, std::string help) {
    Option& option = add(std::move(names), value, std::move(help));
    option.shows_default = true;
    return option;
  }

  /// "--help" and every name of every option that has one, "-o" and "--output" apart.
  std::vector<std::string> names() const;
};

/// A verb with everything its description says.
struct DescribedVerb {
  std::string name, summary;
  Command command;
};

/// What a command line asks for: the verb of that number, or a text to print (help, version).
using Request = std::variant<std::size_t, std::string>;

/// Parses a command line and sets the targets of its options. Throws Error for a line that does not fit the
/// description, saying what was met and, where a verb or option is unknown, the nearest name there is.
Request parse_command_line(const std::vector<DescribedVerb>& verbs, int argc, const char* const* argv);

/// What `nscdd` prints alone: what the program is for, where to begin, and its verbs.
std::string short_guide(const std::vector<DescribedVerb>& verbs);

/// What `nscdd VERB --help` prints, at most 100 columns wide: a line per option, then remarks and examples.
/// Of the help of an option it shows the part before the first "; "; the manual page has it all.
std::string help_screen(const DescribedVerb& verb);

}  // namespace nscdd::app
