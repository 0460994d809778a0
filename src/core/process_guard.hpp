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
    const std::lock_guard lock(mutex_);
    if (guards_++ == 0) before_ = take();
  }
  ~ProcessGuard() {
    const std::lock_guard lock(mutex_);
    if (--guards_ == 0) restore(before_);
  }
  ProcessGuard(const ProcessGuard&) = delete;
  ProcessGuard& operator=(const ProcessGuard&) = delete;

 private:
  inline static std::mutex mutex_;
  inline static long guards_ = 0;
  inline static decltype(take()) before_{};
};

}  // namespace nscdd
