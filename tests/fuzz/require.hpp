// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <cstdlib>

namespace nscdd::fuzzing {

/// Ends the program, which the fuzzer takes for a crash and keeps the input of, where something promised does
/// not hold. An exception would not do: the targets catch those of the parsers.
inline void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

}  // namespace nscdd::fuzzing
