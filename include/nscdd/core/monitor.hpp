// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <functional>

namespace nscdd {

/// Long work calls it after each unit with (units done, units in all). If it returns false, the work stops at
/// once and returns what it has. An empty Monitor is never called.
using Monitor = std::function<bool(Index done, Index total)>;

inline bool report(const Monitor& monitor, Index done, Index total) { return !monitor || monitor(done, total); }

}  // namespace nscdd
