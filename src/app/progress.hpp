// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include <nscdd/core/types.hpp>

#include <fmt/format.h>

#include <string>

namespace nscdd::app {

/// A remark for the user, on standard error, put together by fmt.
void vnote(fmt::string_view format, fmt::format_args arguments);
template <class... Arguments>
void note(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  vnote(format, fmt::make_format_args(arguments...));
}

/// Seconds on a clock that never goes back.
double seconds();

/// A progress bar on standard error with rate and time left, for the life of the object; draws nothing where
/// that is no terminal. Rates are those of this run: `before` units were done when it began.
class Progress {
 public:
  explicit Progress(std::string label, Index before = 0, std::string unit = "point");
  ~Progress();  ///< wipes the bar
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  Monitor monitor();

 private:
  void draw(Index done, Index total);
  std::string label_, unit_;
  Index before_;
  bool terminal_;
  double started_, drawn_ = 0;
};

/// Exit code of work that was stopped before its end, whatever the signal.
inline constexpr int interrupted_exit_code = 130;

/// For the life of the object a first Ctrl-C (SIGINT) or SIGTERM asks the work to stop after the row it is at; a second
/// one ends the program at once. A signal that is ignored already (nohup, a background job) stays ignored.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// `monitor`, and a request to stop once a signal came, unless all is done.
  Monitor watch(Monitor monitor);

  bool stopped() const { return stopped_; }  ///< the work was told to stop before its end

 private:
  bool stopped_ = false;
};

}  // namespace nscdd::app
