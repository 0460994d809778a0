// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/process_guard.hpp"
#include <nscdd/core/types.hpp>

#include <array>
#include <functional>
#include <memory>
#include <mutex>

namespace nscdd {

/// While it lives, parallel work uses at most `threads` threads (0: as many as the machine has). No result depends on
/// it.
class ThreadLimit {
 public:
  explicit ThreadLimit(Index threads);

 private:
  std::shared_ptr<void> control_;
};

int take_one_blas_thread();  ///< returns how many there were
void restore_blas_threads(int threads);

/// While any lives, OpenBLAS keeps to one thread per call in the whole process: its own threads would change the order
/// of sums, and with it the last bits of results. Whatever calls BLAS or LAPACK on more than a few numbers holds one.
/// With another BLAS it does nothing.
using OneBlasThread = ProcessGuard<take_one_blas_thread, restore_blas_threads>;

/// Runs `work`, whose parallel parts may call BLAS from several threads, with one BLAS thread per call. With an
/// OpenBLAS built without locks the work keeps to one thread.
void with_threads(const std::function<void()>& work);

/// work(0) ... work(n - 1) in parallel, each on its own data.
void for_each_in_parallel(Index n, const std::function<void(Index)>& work);

/// Held around every call that may reach METIS, which seeds the C library's random numbers and draws from them:
/// orderings found at the same time would disturb each other. While one lives, others wait, and METIS has a state of
/// these numbers to itself; the state that the process had comes back afterwards.
class OneMetis {
 public:
  OneMetis();
  ~OneMetis();
  OneMetis(const OneMetis&) = delete;
  OneMetis& operator=(const OneMetis&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
  alignas(8) std::array<char, 128> state_{};  // of the size the C library begins with
  char* before_;
};

/// The status of a call of METIS, made while one OneMetis lives. METIS catches SIGTERM, takes it for a failure of its
/// own and hands it to nobody. A call that fails is therefore made again. If it succeeds then, a signal it was, and it
/// is raised again for the process, whose own handlers METIS has put back.
int metis_status(const std::function<int()>& call);

}  // namespace nscdd
