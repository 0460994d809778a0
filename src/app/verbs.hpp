// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"
#include "app/progress.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

namespace nscdd::app {

struct Verb;

/// What the program runs on: this process alone, or several that share the subdomains.
struct Machine {
  std::string program = "nscdd";
  std::vector<std::string> verbs = {};  ///< those that it serves; all of them where it names none
  Processes processes = {};
  Index processes_here = 1;  ///< those that share this computer's memory
  InertiaMethod inertia = multifrontal(processes.counts);
  SpectrumSolver slepc = {};
  Index threads = 0;  ///< default of a process, 0 for all

  bool serves(std::string_view verb) const { return verbs.empty() || std::ranges::find(verbs, verb) != verbs.end(); }
};

/// How a run of the program ended.
struct Outcome {
  int code = 0;       ///< 0 done, 1 a check failed, 2 bad input, 130 interrupted
  std::string error;  ///< what the user is told; empty if there is none, or if another process tells
};

/// Does what a command line asks for.
Outcome run_program(int argc, char** argv, const Machine& machine);

/// What every verb may need to know of the call.
struct Context {
  std::string command_line;        ///< as typed, program name without its folder
  const std::vector<Verb>& verbs;  ///< all verbs with their options
  const Machine& machine;
};

/// What a verb does once its options are parsed. The result is the exit code (0 done, 1 a check failed).
using Action = std::function<int(const Context& context)>;

/// Declares the options of a verb on `command`, which outlives the action, and returns what to do with them.
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

/// What the program prints without a verb: what it is for, where to begin, and its verbs.
std::string short_guide(const std::vector<Verb>& verbs, const Machine& machine);

/// What `nscdd VERB --help` prints, at most 100 columns wide: a line per option, then remarks and examples.
/// Of the help of an option it shows the part before the first "; "; the manual page has it all.
std::string help_screen(const Verb& verb);

}  // namespace nscdd::app
