// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"
#include "app/progress.hpp"
#include <nscdd/ddm/bddc.hpp>
#include <nscdd/spectra/spectral_radius.hpp>

namespace nscdd::app {

struct Verb;

/// What the program runs on: one process, or several that share the subdomains.
struct Machine {
  std::string program = "nscdd";
  std::vector<std::string> verbs = {};  ///< available verbs; empty: all
  Processes processes = {};
  Index processes_here = 1;  ///< ranks that share the memory of this computer
  InertiaMethod inertia = multifrontal(processes.counts);
  SpectrumSolver slepc = {};
  Bddc bddc = {};
  Index threads = 0;  ///< default of a rank; 0: all

  bool serves(std::string_view verb) const { return verbs.empty() || std::ranges::find(verbs, verb) != verbs.end(); }
};

struct Outcome {
  int code = 0;       ///< 0 done, 1 a check failed, 2 bad input, 130 interrupted
  std::string error;  ///< message for the user; empty without an error, or if another rank reports it
};

/// Opens the standard streams that are closed, so that no output gets their numbers and messages with them. What is
/// written to them is lost, with an error as before.
void open_standard_streams();

/// Runs a command line.
Outcome run_program(int argc, char** argv, const Machine& machine);

struct Context {
  std::string command_line;        ///< as typed, program name without its folder
  const std::vector<Verb>& verbs;  ///< all verbs with their options
  const Machine& machine;
};

/// Runs a verb with its parsed options; returns the exit code (0 done, 1 a check failed).
using Action = std::function<int(const Context& context)>;

/// Declares the options of a verb on `command`, which must outlive the returned action.
using Declaration = Action(Command& command);

struct Verb {
  std::string name, summary;
  Declaration* declare;
  Command command = {};
  Action action = {};
};

Declaration declare_sweep, declare_run, declare_network, declare_inspect, declare_optimum, declare_generate,
    declare_modes, declare_report, declare_solve, declare_simulate, declare_export, declare_coarse, declare_list,
    declare_manual;

/// Text of `nscdd` without a verb: purpose, first examples, verbs.
std::string short_guide(const std::vector<Verb>& verbs, const Machine& machine);

/// Text of `nscdd VERB --help`, at most 100 columns wide: a line per option, then remarks and examples. The help of an
/// option ends at its first "; "; the manual page has all of it.
std::string help_screen(const Verb& verb);

}  // namespace nscdd::app
