// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/process_guard.hpp"
#include <nscdd/core/types.hpp>

namespace nscdd {

/// While it lives, parallel work has at most `threads` threads (0: all of the machine). No result depends on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(Index threads);

 private:
  std::shared_ptr<void> control_;
};

int take_one_blas_thread();  ///< returns how many there were
void restore_blas_threads(int threads);

/// While any lives, OpenBLAS keeps to one thread per call in the whole process: its threads would change the order of
/// sums and the last bits of results. Whatever calls BLAS or LAPACK on more than a few numbers holds one.
using OneBlasThread = ProcessGuard<take_one_blas_thread, restore_blas_threads>;

/// Runs parallel `work` with one BLAS thread per call; on one thread in all if OpenBLAS was built without locks.
void with_threads(const std::function<void()>& work);

/// work(0) ... work(n - 1) in parallel, each on its own data.
void for_each_in_parallel(Index n, const std::function<void(Index)>& work);

/// The status of a call that may reach METIS, which seeds the C library's random numbers and draws from them: two
/// orderings found at the same time would disturb each other. Such calls are therefore made one at a time. Each has a
/// state of these numbers to itself, and the state that the process had comes back afterwards.
///
/// METIS catches SIGTERM, takes it for a failure of its own and hands it to nobody. A call that fails is therefore made
/// again. If it then succeeds, there was a signal. It is raised again for the process, whose handlers METIS put back.
int metis_status(const std::function<int()>& call);

}  // namespace nscdd
