// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/threads.hpp"

#include <metis.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <csignal>
#include <cstdlib>

// Null unless the BLAS is OpenBLAS.
extern "C" {
__attribute__((weak)) void openblas_set_num_threads(int);
__attribute__((weak)) int openblas_get_num_threads();
__attribute__((weak)) int openblas_get_parallel();
}

namespace nscdd {

ThreadLimit::ThreadLimit(Index threads) {
  using tbb::global_control;
  if (threads > 0) control_ = std::make_shared<global_control>(global_control::max_allowed_parallelism, at(threads));
}

int take_one_blas_thread() {
  if (openblas_get_num_threads == nullptr) return 1;
  const int before = openblas_get_num_threads();
  if (before != 1) openblas_set_num_threads(1);
  return before;
}

void restore_blas_threads(int threads) {
  if (threads != 1) openblas_set_num_threads(threads);
}

void with_threads(const std::function<void()>& work) {
  const OneBlasThread serial_blas;
  const bool unlocked = openblas_get_parallel != nullptr && openblas_get_parallel() == 0;
  if (unlocked) {
    tbb::task_arena(1).execute(work);
  } else {
    // A waiting thread may hold a lock; `isolate` keeps TBB from handing it unrelated work, which could deadlock.
    tbb::this_task_arena::isolate(work);
  }
}

void for_each_in_parallel(Index n, const std::function<void(Index)>& work) {
  with_threads([&] { tbb::parallel_for(Index{0}, n, work, tbb::simple_partitioner()); });
}

int metis_status(const std::function<int()>& call) {
  static std::mutex one_at_a_time;
  alignas(8) char numbers[128];  // the default size of the C library
  std::unique_lock lock(one_at_a_time);
  char* const before = initstate(1, numbers, sizeof numbers);
  struct sigaction handler {};
  sigaction(SIGTERM, nullptr, &handler);
  int status = call();
  const bool failed = status == METIS_ERROR;
  if (failed) status = call();
  sigaction(SIGTERM, &handler, nullptr);
  setstate(before);
  lock.unlock();
  if (failed && status == METIS_OK) std::raise(SIGTERM);
  return status;
}

}  // namespace nscdd
