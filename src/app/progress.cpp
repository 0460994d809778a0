// SPDX-License-Identifier: GPL-3.0-or-later
#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace nscdd::app {
namespace {

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Progress::Progress(std::string label)
    : label_(std::move(label)), terminal_(isatty(STDERR_FILENO) != 0), started_(seconds()) {}

Progress::~Progress() {
  if (terminal_ && drawn_ > 0) fmt::print(stderr, "\r\033[K");
}

Monitor Progress::monitor() {
  if (!terminal_) return {};
  return [this](Index done, Index total) {
    draw(done, total);
    return true;
  };
}

void Progress::draw(Index done, Index total) {
  const double now = seconds();
  if (now - drawn_ < 0.1 || total <= 0) return;
  drawn_ = now;
  const double fraction = static_cast<double>(done) / static_cast<double>(total);
  constexpr int width = 30;
  const int filled = static_cast<int>(fraction * width);
  const double left = fraction > 0 ? (now - started_) * (1 - fraction) / fraction : 0;
  fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} % {:.0f} s left", label_, "", filled, "",
             width - filled, 100 * fraction, left);
  std::fflush(stderr);
}

void note(const std::string& text) {
  // Where even standard error cannot be written there is nobody left to tell: no exception.
  std::fputs(("nscdd: " + text + "\n").c_str(), stderr);
}

}  // namespace nscdd::app
