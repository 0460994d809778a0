// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>

namespace nscdd {

/// Holds a setting that the whole process shares, such as an error handler of a library. While any guard
/// lives the setting is ours; the last guard to go puts back what the first one met, however the guards of
/// several threads overlap. `take` changes the setting and returns what it was, `restore` sets that again.
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
