// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <functional>
#include <memory>

namespace nscdd {

/// While it lives, parallel work uses at most `threads` threads (0: as many as the machine has).
/// No result depends on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(Index threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Runs `work`, whose parallel parts may call BLAS from several threads: an OpenBLAS that threads by itself
/// is told to keep to one thread per call (its own threads would change the order of sums), and with one that
/// was built without locks the work keeps to one thread.
void with_threads(const std::function<void()>& work);

/// work(0) ... work(n - 1) in parallel, each on its own data.
void for_each_in_parallel(Index n, const std::function<void(Index)>& work);

}  // namespace nscdd
