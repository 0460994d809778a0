// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include <nscdd/core/processes.hpp>
#include <nscdd/spectra/spectral_radius.hpp>

#include <deque>
#include <variant>

namespace nscdd::app {

/// A remark for the user, on standard error, put together by fmt.
void vnote(fmt::string_view format, fmt::format_args arguments);
template <class... Arguments>
void note(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  vnote(format, fmt::make_format_args(arguments...));
}

/// Seconds on a clock that never goes back.
double seconds();

/// A monitor that shows a progress bar on standard error, with the rate and the time left. It shows nothing where
/// standard error is no terminal. `before` units were done when this run began; its rate is that of the others. The
/// bar is wiped when the last copy of the monitor goes.
Monitor progress(std::string label, Index before = 0, std::string unit = "point");

/// Exit code of work that was stopped before its end, whatever the signal.
inline constexpr int interrupted_exit_code = 130;

/// For the life of the object a first Ctrl-C (SIGINT) or SIGTERM asks the work to stop after the row it is at; a second
/// one ends the program at once. A signal that is ignored already (nohup, a background job) stays ignored.
class Interruption {
 public:
  /// `processes`: stop together.
  explicit Interruption(Processes processes = {});
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// Shows the `progress` of that name. Asks the work to stop once a signal came, unless all of it is done.
  Monitor watch(std::string label, Index before = 0, std::string unit = "point");

  bool stopped() const { return stopped_; }  ///< the work was told to stop before its end

 private:
  Processes processes_;
  bool stopped_ = false;
};

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
  std::string value = {};  ///< what stands for its value in the help, such as FILE; by the type where empty
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

  /// `form`: names, and after a blank what stands for the value, "-o,--output FILE".
  template <class Value>
  Option& add(const std::string& form, Value& value, std::string help) {
    return add_target(form, &value, std::move(help));
  }
  template <class Value>
  Option& required(const std::string& form, Value& value, std::string help) {
    Option& option = add(form, value, std::move(help));
    option.required = true;
    return option;
  }
  /// One whose help shows the value that it has if it is not given.
  template <class Value>
  Option& preset(const std::string& form, Value& value, std::string help) {
    Option& option = add(form, value, std::move(help));
    option.shows_default = true;
    return option;
  }

  /// "--help" and every name of every option that has one, "-o" and "--output" apart.
  std::vector<std::string> names() const;

 private:
  Option& add_target(const std::string& form, Option::Target target, std::string help);
};

struct Verb;

/// What the program runs on: this process alone, or several that share the subdomains.
struct Machine {
  std::string program = "nscdd";
  std::vector<std::string> verbs = {};  ///< those that it serves; all of them where it names none
  Processes processes = {};
  Index processes_here = 1;  ///< those that share this computer's memory
  InertiaMethod inertia = multifrontal(processes.counts);
  SpectrumSolver slepc = {};
  Index threads = 0;  ///< of a process where nothing is said, 0 for all

  bool serves(std::string_view verb) const { return verbs.empty() || std::ranges::find(verbs, verb) != verbs.end(); }
};

/// What every verb may need to know of the call.
struct Context {
  std::string command_line;        ///< as typed, program name without its folder
  const std::vector<Verb>& verbs;  ///< all verbs with their options
  const Machine& machine;
};

/// What a verb does once its options are parsed. The result is the exit code (0 done, 1 a check failed).
using Action = std::function<int(const Context& context)>;

/// Declares the options of a verb on `command` and returns what to do with them.
using Declaration = Action(Command& command);

/// A verb with everything its description says.
struct Verb {
  std::string name, summary;
  Declaration* declare;
  Command command = {};
  Action action = {};
};

Declaration declare_sweep, declare_run, declare_network, declare_inspect, declare_optimum, declare_generate,
    declare_modes, declare_report, declare_solve, declare_simulate, declare_export, declare_list, declare_manual;

/// What the program prints alone: what the program is for, where to begin, and its verbs.
std::string short_guide(const std::vector<Verb>& verbs, const Machine& machine);

/// What `nscdd VERB --help` prints, at most 100 columns wide: a line per option, then remarks and examples.
/// Of the help of an option it shows the part before the first "; "; the manual page has it all.
std::string help_screen(const Verb& verb);

}  // namespace nscdd::app
