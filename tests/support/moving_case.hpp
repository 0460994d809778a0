// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace nscdd::testing {

/// A case file: a deposit of 120 grains in a box of disks whose side walls turn about their feet, two
/// subdomains, generic algorithm with warm start. A step takes about a millisecond.
std::string moving_case();

/// The same of 30 grains and 12 steps.
std::string small_moving_case();

/// A case file: `packing` is the path of a file, or a generator with lines of its parameters; `grid`
/// is its partition, such as "2, 1".
std::string case_text(const std::string& packing, const std::string& grid = "1, 1", const std::string& more = "");

}  // namespace nscdd::testing
