// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>

namespace nscdd {

/// Guard of a process-wide setting, such as a library's error handler. Of the guards that overlap, in any threads, the
/// first one changes the setting by `take`, which returns its old value; the last one sets it back by `restore`.
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
