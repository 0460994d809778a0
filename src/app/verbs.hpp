// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"

#include <functional>
#include <string>
#include <vector>

namespace nscdd::app {

/// What every verb may need to know of the call.
struct Context {
  std::string command_line;                           ///< as typed, program name without its folder
  const std::vector<DescribedVerb>* verbs = nullptr;  ///< all verbs with their options
};

/// What a verb does once its options are parsed. The result is the exit code (0 done, 1 a check failed).
using Action = std::function<int(const Context& context)>;

/// A verb: declares its options on `command` and returns what to do with them.
using Declaration = Action(Command& command);
struct Verb {
  const char* name;
  const char* summary;
  Declaration* declare;
};

Declaration declare_sweep, declare_run, declare_network, declare_inspect, declare_optimum, declare_generate,
    declare_modes, declare_solve, declare_simulate, declare_export, declare_list, declare_manual;

}  // namespace nscdd::app
