// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include <nscdd/core/processes.hpp>

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

/// Notes that work was interrupted; returns the exit code, which is the same for SIGINT and SIGTERM.
template <class... Arguments>
int interrupted(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  vnote(format, fmt::make_format_args(arguments...));
  return 130;
}

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

}  // namespace nscdd::app
