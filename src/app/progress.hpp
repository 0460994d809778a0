// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/monitor.hpp>

#include <string>

namespace nscdd::app {

/// A progress bar on standard error, for the life of the object; draws nothing where that is no terminal.
class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();  ///< wipes the bar
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  Monitor monitor();

 private:
  void draw(Index done, Index total);
  std::string label_;
  bool terminal_;
  double started_, drawn_ = 0;
};

/// A remark for the user, on standard error.
void note(const std::string& text);

}  // namespace nscdd::app
