// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"
#include "study/memory_estimate.hpp"

#include <optional>
#include <string_view>

namespace nscdd::app {

/// Memory that a run may take, and its refusal before the run begins.
struct MemoryLimit {
  std::optional<double> gibibytes;  ///< as given; else 90 % of what is available

  void declare(Command& command);

  /// Throws Error with both amounts where the need exceeds the limit.
  void require(const MemoryNeed& need) const;

  /// The same for other work on a case: `what` takes the memory, `advice` may help beside a larger limit.
  void require(double bytes, std::string_view name, std::string_view what, std::string_view advice) const;
};

/// Bytes that a new run can take without swapping: MemAvailable of /proc/meminfo, and what the control groups
/// that the program is in leave of their limits; infinite where the system tells neither.
double available_bytes();

}  // namespace nscdd::app
