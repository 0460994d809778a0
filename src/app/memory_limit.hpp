// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"

namespace nscdd::app {

/// The memory that a run may use. Work that needs more is refused where its size is known exactly (require_memory).
struct MemoryLimit {
  std::optional<double> gibibytes;  ///< as given; else 90 % of what is available

  void declare(Command& command);

  /// Limits this process, one of so many that share the memory of a computer. Throws Error if it holds more already.
  void apply(Index processes = 1) const;
};

/// Returns freed memory to the system. Otherwise the memory of the whole packing would stay with the process, see
/// keep_freed_memory.
void give_back_freed_memory();

}  // namespace nscdd::app
