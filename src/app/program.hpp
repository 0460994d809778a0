// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"

namespace nscdd::app {

/// How a run of the program ended.
struct Outcome {
  int code = 0;       ///< 0 done, 1 a check failed, 2 bad input, 130 interrupted
  std::string error;  ///< what the user is told; empty if there is none, or if another process tells
};

/// Does what a command line asks for.
Outcome run_program(int argc, char** argv, const Machine& machine);

}  // namespace nscdd::app
