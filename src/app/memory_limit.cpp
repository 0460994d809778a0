// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/memory_limit.hpp"

#include "core/memory.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace nscdd::app {

void MemoryLimit::declare(Command& command) {
  command.add("--memory-limit", gibibytes,
              "memory the run may take, GiB; a run that needs more is refused; by default 90 % of what is available",
              {.description = "", .minimum = 0, .minimum_excluded = true});
}

void MemoryLimit::apply(Index processes) const {
  if (gibibytes) limit_memory(*gibibytes * gibibyte / static_cast<double>(processes));
  require_memory(smallest_checked_need, "the work itself");
}

void give_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace nscdd::app
