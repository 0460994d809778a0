// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace nscdd::app {

/// An option of a verb, described once: the command line is parsed by it, and help, manual pages and the
/// completion of the shell are made from it. The setters return the option itself, to be chained.
class Option {
 public:
  /// Where the value goes. An empty optional stays empty, and a list stays as it is, where the option is not
  /// given; a bool makes the option a flag.
  using Target = std::variant<std::string*, double*, Index*, bool*, std::optional<std::string>*, std::optional<double>*,
                              std::optional<Index>*, std::vector<std::string>*>;

  Option(std::string names, Target target, std::string help)
      : names_(std::move(names)), target_(target), help_(std::move(help)) {}

  Option* required();
  Option* shows_default();                         ///< the help prints the value that the target has now
  Option* one_of(std::vector<std::string> words);  ///< the only values that are accepted
  Option* between(Index smallest, Index largest);
  Option* needs(const Option* other);  ///< refused without the other one
  Option* excludes(const Option* other);

  const std::string& names() const { return names_; }  ///< "-o,--output", or "CASE" where it has no name
  bool positional() const { return names_.front() != '-'; }
  bool flag() const { return std::holds_alternative<bool*>(target_); }
  const Target& target() const { return target_; }
  const std::string& help() const { return help_; }
  const std::vector<std::string>& words() const { return words_; }
  const std::optional<std::pair<Index, Index>>& bounds() const { return bounds_; }
  bool is_required() const { return required_; }
  bool has_default() const { return shows_default_; }
  const std::vector<const Option*>& needed() const { return needed_; }
  const std::vector<const Option*>& excluded() const { return excluded_; }

 private:
  std::string names_;
  Target target_;
  std::string help_;
  std::vector<std::string> words_;
  std::optional<std::pair<Index, Index>> bounds_;
  bool required_ = false, shows_default_ = false;
  std::vector<const Option*> needed_, excluded_;
};

/// The options of one verb, in the order of its help.
class Command {
 public:
  Option* add_option(std::string names, Option::Target target, std::string help);
  Option* add_flag(std::string names, bool& target, std::string help);
  void footer(std::string text) { footer_ = std::move(text); }

  template <class Value>
  Option* add_option(std::string names, Value& value, std::string help) {
    return add_option(std::move(names), Option::Target(&value), std::move(help));
  }

  const std::deque<Option>& options() const { return options_; }
  const std::string& footer() const { return footer_; }  ///< remarks and examples below the options

 private:
  std::deque<Option> options_;  // addresses stay: options name each other
  std::string footer_;
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

}  // namespace nscdd::app
