// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace nscdd::app {
namespace {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

Progress::Progress(std::string label, Index before, std::string unit)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      before_(before),
      terminal_(isatty(STDERR_FILENO) != 0),
      started_(seconds()) {}

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
  std::string speed;
  if (done > before_) {
    const double each = (now - started_) / static_cast<double>(done - before_);
    speed =
        fmt::format(", {}, {} left", rate_text(each, unit_), duration_text(each * static_cast<double>(total - done)));
  }
  fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} %{}", label_, "", filled, "", width - filled, 100 * fraction,
             speed);
  std::fflush(stderr);
}

std::string rate_text(double seconds_per_point, const std::string& unit) {
  return seconds_per_point < 1 ? fmt::format("{:.3g} {}s/s", 1 / std::max(seconds_per_point, 1e-9), unit)
                               : fmt::format("{:.3g} s/{}", seconds_per_point, unit);
}

std::string duration_text(double seconds) {
  const auto whole = std::llround(std::min(seconds, 1e15));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  if (whole < 86400) return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
  return fmt::format("{} d {} h", whole / 86400, whole % 86400 / 3600);
}

void note(const std::string& text) {
  // Where even standard error cannot be written there is nobody left to tell: no exception.
  std::fputs(("nscdd: " + text + "\n").c_str(), stderr);
}

}  // namespace nscdd::app
