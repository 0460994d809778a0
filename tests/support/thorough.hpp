// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>

namespace nscdd::testing {

/// Whether a test that tries many inputs of a kind has the time for all of them: tools/nightly sets NSCDD_THOROUGH.
inline bool thorough() { return std::getenv("NSCDD_THOROUGH") != nullptr; }

}  // namespace nscdd::testing
