// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/progress.hpp"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>

namespace nscdd::app {
namespace {

// "12 s", "3 min 20 s", "5 h 12 min", "3 d 4 h".
std::string duration_text(double seconds) {
  const auto whole = std::llround(std::min(seconds, 1e15));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  if (whole < 86400) return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
  return fmt::format("{} d {} h", whole / 86400, whole % 86400 / 3600);
}

struct ProgressBar {
  std::string label, unit;
  Index before;
  double started = seconds(), drawn = 0;

  ~ProgressBar() {
    if (drawn > 0) fmt::print(stderr, "\r\033[K");
  }
  void draw(Index done, Index total) {
    const double now = seconds();
    if (now - drawn < 0.1 || total <= 0) return;
    drawn = now;
    const double fraction = static_cast<double>(done) / static_cast<double>(total);
    constexpr int width = 30;
    const int filled = static_cast<int>(fraction * width);
    std::string speed;
    if (done > before) {
      const double each = (now - started) / static_cast<double>(done - before);
      speed = each < 1 ? fmt::format(", {:.3g} {}s/s", 1 / std::max(each, 1e-9), unit)
                       : fmt::format(", {:.3g} s/{}", each, unit);
      speed += fmt::format(", {} left", duration_text(each * static_cast<double>(total - done)));
    }
    fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} %{}", label, "", filled, "", width - filled, 100 * fraction,
               speed);
    std::fflush(stderr);
  }
};

constexpr std::array<int, 2> signals{SIGINT, SIGTERM};

volatile std::sig_atomic_t requested = 0;     // a signal handler can reach nothing that is not global
volatile std::sig_atomic_t requested_at = 0;  // s

// A second signal has its usual effect, unless it comes with the first: `timeout` sends two.
void request(int signal) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const auto second = static_cast<std::sig_atomic_t>(now.tv_sec);
  if (requested == 0) {
    requested_at = second;
    requested = 1;
  } else if (second > requested_at + 1) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

void vnote(fmt::string_view format, fmt::format_args arguments) {
  // Not fmt::print, which throws if standard error cannot be written: nobody would see it.
  std::fputs(("nscdd: " + fmt::vformat(format, arguments) + "\n").c_str(), stderr);
}

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

Monitor progress(std::string label, Index before, std::string unit) {
  if (isatty(STDERR_FILENO) == 0) return {};
  const std::shared_ptr<ProgressBar> bar(new ProgressBar{std::move(label), std::move(unit), before});
  return [bar](Index done, Index total) {
    bar->draw(done, total);
    return true;
  };
}

Interruption::Interruption(Processes processes) : processes_(std::move(processes)) {
  requested = 0;
  for (const int signal : signals) {
    struct sigaction action {
    }, before{};
    action.sa_handler = request;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

Interruption::~Interruption() {
  for (const int signal : signals) {
    struct sigaction present {};
    sigaction(signal, nullptr, &present);
    if (present.sa_handler == request) std::signal(signal, SIG_DFL);
  }
}

Monitor Interruption::watch(std::string label, Index before, std::string unit) {
  return [this, bar = progress(std::move(label), before, std::move(unit))](Index done, Index total) {
    report(bar, done, total);
    const bool asked = processes_.any(requested != 0);
    stopped_ = stopped_ || (asked && done < total);
    return !stopped_;
  };
}

}  // namespace nscdd::app
