// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace nscdd {

/// Version of this library, "major.minor.patch".
std::string version();

/// 16 hexadecimal digits that change with any source of the program, its compiler or its settings: two builds
/// of one version with different ones need not give equal bits.
std::string build_fingerprint();

/// Name and version of every library that the numbers depend on, in a fixed order.
std::vector<std::pair<std::string, std::string>> dependency_versions();

}  // namespace nscdd
