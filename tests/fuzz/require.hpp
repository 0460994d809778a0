// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <cstdio>
#include <cstdlib>
#include <optional>

namespace nscdd::fuzzing {

/// Ends the program if a promise does not hold. The fuzzer takes that for a crash and keeps the input. An exception
/// would not do, because the targets catch those of the parsers.
inline void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

/// What the work returns; nothing for an Error.
template <class Work>
auto unless_error(Work&& work) -> std::optional<decltype(work())> {
  try {
    return work();
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace nscdd::fuzzing
