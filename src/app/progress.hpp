// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <string>

namespace nscdd::app {

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

/// "3.2 points/s" for seconds per point below 1, else "4.5 s/point"; or of another unit.
std::string rate_text(double seconds_per_point, const std::string& unit = "point");

/// "12 s", "3 min 20 s", "5 h 12 min", "3 d 4 h".
std::string duration_text(double seconds);

/// A remark for the user, on standard error.
void note(const std::string& text);

}  // namespace nscdd::app
