// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/threads.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <optional>

// There where the BLAS is OpenBLAS, null where it is another.
extern "C" {
__attribute__((weak)) void openblas_set_num_threads(int);
__attribute__((weak)) int openblas_get_parallel();
}

namespace nscdd {

class ThreadLimit::Implementation {
 public:
  explicit Implementation(Index threads) {
    if (threads > 0) control.emplace(tbb::global_control::max_allowed_parallelism, at(threads));
  }
  std::optional<tbb::global_control> control;
};

ThreadLimit::ThreadLimit(Index threads) : implementation_(std::make_unique<Implementation>(threads)) {}
ThreadLimit::~ThreadLimit() = default;

void with_threads(const std::function<void()>& work) {
  const bool unlocked = openblas_get_parallel != nullptr && openblas_get_parallel() == 0;
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
  if (unlocked) {
    tbb::task_arena(1).execute(work);
  } else {
    tbb::this_task_arena::isolate(
        work);  // who waits inside, perhaps with a lock, takes up nothing from outside
  }
}

void for_each_in_parallel(Index n, const std::function<void(Index)>& work) {
  with_threads([&] { tbb::parallel_for(Index{0}, n, work, tbb::simple_partitioner()); });
}

}  // namespace nscdd
