// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <string>

namespace nscdd::app {

/// What every verb may need to know of the call.
struct Context {
  std::string command_line;  ///< as typed, program name without its folder
};

/// A verb: declares its options on `command` and returns what to do once they are parsed; the result of that
/// is the exit code (0 done, 1 a check failed).
struct Verb {
  const char* name;
  const char* summary;
  std::function<int()> (*declare)(CLI::App& command, const Context& context);
};

std::function<int()> declare_sweep(CLI::App& command, const Context& context);
std::function<int()> declare_run(CLI::App& command, const Context& context);
std::function<int()> declare_network(CLI::App& command, const Context& context);
std::function<int()> declare_inspect(CLI::App& command, const Context& context);
std::function<int()> declare_optimum(CLI::App& command, const Context& context);
std::function<int()> declare_generate(CLI::App& command, const Context& context);
std::function<int()> declare_modes(CLI::App& command, const Context& context);
std::function<int()> declare_solve(CLI::App& command, const Context& context);
std::function<int()> declare_simulate(CLI::App& command, const Context& context);
std::function<int()> declare_export(CLI::App& command, const Context& context);
std::function<int()> declare_list(CLI::App& command, const Context& context);

}  // namespace nscdd::app
