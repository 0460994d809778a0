// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/process_guard.hpp"
#include <nscdd/core/types.hpp>

namespace nscdd {

/// Limits the threads of parallel work for its lifetime (0: all of the machine). No result depends on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(Index threads);

 private:
  std::shared_ptr<void> control_;
};

int take_one_blas_thread();  ///< returns the previous number
void restore_blas_threads(int threads);

/// Guard that limits OpenBLAS to one thread per call in the whole process, since its threads would change the last bits
/// of results. Callers of BLAS or LAPACK on more than a few numbers hold one.
using OneBlasThread = ProcessGuard<take_one_blas_thread, restore_blas_threads>;

/// Runs parallel `work` with one BLAS thread per call; on a single thread if OpenBLAS was built without locks.
void with_threads(const std::function<void()>& work);

/// work(0) ... work(n - 1) in parallel, each on its own data.
void for_each_in_parallel(Index n, const std::function<void(Index)>& work);

/// Calls METIS, one call at a time, and returns its status. METIS seeds and uses the C library's random numbers, so
/// each call has its own state of these; the state of the process is restored afterwards.
///
/// METIS catches SIGTERM, treats it as its own failure, and leaves a handler that acts once. So a failing call is
/// repeated; if it then succeeds, the signal is raised again, with the handler of the process, which is put back.
int metis_status(const std::function<int()>& call);

}  // namespace nscdd
