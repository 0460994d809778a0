// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/process_guard.hpp"
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

int take_one_blas_thread();  ///< returns how many there were
void restore_blas_threads(int threads);

/// While any lives, OpenBLAS keeps to one thread per call: its own threads would change the order of sums,
/// and with it the last bits of results. Whatever calls BLAS or LAPACK on more than a few numbers holds one.
/// The BLAS calls of other parts of the process keep to one thread meanwhile. With another BLAS it does
/// nothing.
using OneBlasThread = ProcessGuard<take_one_blas_thread, restore_blas_threads>;

/// Runs `work`, whose parallel parts may call BLAS from several threads, with one BLAS thread per call. With
/// an OpenBLAS that was built without locks the work keeps to one thread.
void with_threads(const std::function<void()>& work);

/// work(0) ... work(n - 1) in parallel, each on its own data.
void for_each_in_parallel(Index n, const std::function<void(Index)>& work);

}  // namespace nscdd
