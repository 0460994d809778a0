// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/interruption.hpp"

#include <array>
#include <csignal>
#include <utility>

namespace nscdd::app {
namespace {

constexpr std::array<int, 2> signals{SIGINT, SIGTERM};

volatile std::sig_atomic_t requested = 0;  // a signal handler can reach nothing that is not global

void request(int) { requested = 1; }

}  // namespace

Interruption::Interruption() {
  requested = 0;
  for (const int signal : signals) {
    struct sigaction action {
    }, before{};
    action.sa_handler = request;
    action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);  // the second one has its usual effect
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

Monitor Interruption::watch(Monitor monitor) {
  return [this, inner = std::move(monitor)](Index done, Index total) {
    if (!report(inner, done, total)) return false;
    stopped_ = stopped_ || (requested != 0 && done < total);
    return !stopped_;
  };
}

}  // namespace nscdd::app
