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

/// A verb: declares its options on `command` and returns what to do once they are parsed; the result of that
/// is the exit code (0 done, 1 a check failed).
struct Verb {
  const char* name;
  const char* summary;
  std::function<int()> (*declare)(Command& command, const Context& context);
};

std::function<int()> declare_sweep(Command& command, const Context& context);
std::function<int()> declare_run(Command& command, const Context& context);
std::function<int()> declare_network(Command& command, const Context& context);
std::function<int()> declare_inspect(Command& command, const Context& context);
std::function<int()> declare_optimum(Command& command, const Context& context);
std::function<int()> declare_generate(Command& command, const Context& context);
std::function<int()> declare_modes(Command& command, const Context& context);
std::function<int()> declare_solve(Command& command, const Context& context);
std::function<int()> declare_simulate(Command& command, const Context& context);
std::function<int()> declare_export(Command& command, const Context& context);
std::function<int()> declare_list(Command& command, const Context& context);
std::function<int()> declare_manual(Command& command, const Context& context);

}  // namespace nscdd::app
