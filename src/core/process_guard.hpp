// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>

namespace nscdd {

/// Guard of a process-wide setting, such as a library's error handler. The first guard takes the setting, the last one
/// restores it, in any overlap of threads. `take` changes the setting and returns its old value, `restore` sets it
/// back.
template <auto take, auto restore>
class ProcessGuard {
 public:
  ProcessGuard() {
    State& s = state();
    const std::lock_guard lock(s.mutex);
    if (s.guards++ == 0) s.before = take();
  }
  ~ProcessGuard() {
    State& s = state();
    const std::lock_guard lock(s.mutex);
    if (--s.guards == 0) restore(s.before);
  }
  ProcessGuard(const ProcessGuard&) = delete;
  ProcessGuard& operator=(const ProcessGuard&) = delete;

 private:
  struct State {
    std::mutex mutex;
    long guards = 0;
    decltype(take()) before{};
  };
  static State& state() {
    static State one;
    return one;
  }
};

}  // namespace nscdd
