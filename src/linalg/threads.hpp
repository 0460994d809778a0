// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/process_guard.hpp"
#include <nscdd/core/types.hpp>

namespace nscdd {

/// Limit of the threads of parallel work, for its lifetime (0: all of the machine). No result depends on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(Index threads);

 private:
  std::shared_ptr<void> control_;
};

int take_one_blas_thread();  ///< returns the previous number
void restore_blas_threads(int threads);

/// Guard that keeps OpenBLAS to one thread per call in the whole process: its threads would change the order of sums
/// and the last bits of results. Callers of BLAS or LAPACK on more than a few numbers hold one.
using OneBlasThread = ProcessGuard<take_one_blas_thread, restore_blas_threads>;

/// Runs parallel `work` with one BLAS thread per call; on one thread in all if OpenBLAS was built without locks.
void with_threads(const std::function<void()>& work);

/// work(0) ... work(n - 1) in parallel, each on its own data.
void for_each_in_parallel(Index n, const std::function<void(Index)>& work);

/// Calls METIS, one call at a time, and returns its status. METIS seeds the C library's random numbers and draws from
/// them, so concurrent calls would disturb each other. Each call has its own state of these numbers; the state of the
/// process is restored afterwards.
///
/// METIS catches SIGTERM, takes it for its own failure and does not pass it on. So a failing call is repeated. If it
/// then succeeds, there was a signal, which is raised again for the process with its restored handlers.
int metis_status(const std::function<int()>& call);

}  // namespace nscdd
