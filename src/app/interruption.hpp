// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd::app {

/// Exit code of work that was stopped before its end, whatever the signal.
inline constexpr int interrupted_exit_code = 130;

/// For the life of the object a first Ctrl-C (SIGINT) or SIGTERM asks the work to stop after the row it is
/// at; a second one ends the program at once. A signal that is ignored already (nohup, a background job)
/// stays ignored.
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
