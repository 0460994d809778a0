// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <functional>

namespace nscdd {

/// Called by long work after each unit with (units done, units in all); returning false asks the work
/// to stop, which it does at once with what it has. An empty Monitor is never called.
using Monitor = std::function<bool(Index done, Index total)>;

inline bool report(const Monitor& monitor, Index done, Index total) {
  return !monitor || monitor(done, total);
}

}  // namespace nscdd
