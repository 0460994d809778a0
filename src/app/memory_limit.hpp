// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "study/linear/memory_estimate.hpp"

namespace nscdd::app {

/// Memory that a run may take, and its refusal before the run begins.
struct MemoryLimit {
  std::optional<double> gibibytes;  ///< as given; else 90 % of what is available

  void declare(Command& command);

  void require(const MemoryNeed& need) const;  ///< throws Error with both amounts where the need exceeds the limit
  /// The same where processes share the work: what those on one computer need of it. `need`: of all.
  void require(MemoryNeed need, const Machine& machine) const;
};

/// Gives memory that is free again back to the system: what a whole packing took would stay with the process, see
/// keep_freed_memory.
void give_back_freed_memory();

}  // namespace nscdd::app
