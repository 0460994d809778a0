// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include <nscdd/core/processes.hpp>

namespace nscdd::app {

/// Prints a remark, formatted by fmt, on standard error.
void vnote(fmt::string_view format, fmt::format_args arguments);
template <class... Arguments>
void note(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  vnote(format, fmt::make_format_args(arguments...));
}

/// Monotonic time, s.
double seconds();

/// A monitor that shows a progress bar with rate and time left, if standard error is a terminal. The rate leaves out
/// the `before` units done by earlier runs. The last copy of the monitor wipes the bar.
Monitor progress(std::string label, Index before = 0, std::string unit = "point");

/// Prints a note about an interruption; returns the exit code, equal for SIGINT and SIGTERM.
template <class... Arguments>
int interrupted(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  vnote(format, fmt::make_format_args(arguments...));
  return 130;
}

/// Handles SIGINT (Ctrl-C) and SIGTERM while it lives: the first stops the work after the current row on all ranks,
/// another one that does not come with it (`timeout` sends two) ends the program at once. Signals that are already
/// ignored (nohup, background jobs) stay ignored.
class Interruption {
 public:
  explicit Interruption(Processes processes = {});
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// Shows `progress`, and stops unfinished work after a signal.
  Monitor watch(std::string label, Index before = 0, std::string unit = "point");

  bool stopped() const { return stopped_; }  ///< the work was stopped before its end

 private:
  Processes processes_;
  bool stopped_ = false;
};

}  // namespace nscdd::app
