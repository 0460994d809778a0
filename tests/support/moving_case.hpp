// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace nscdd::testing {

/// A case file: a deposit of 120 grains in a box of disks whose side walls turn about their feet, two
/// subdomains, generic algorithm with warm start. A step takes about a millisecond.
std::string moving_case();

}  // namespace nscdd::testing
