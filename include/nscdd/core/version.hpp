// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace nscdd {

/// Version of this library, "major.minor.patch".
std::string version();

/// Name and version of every library that the numbers depend on, in a fixed order.
std::vector<std::pair<std::string, std::string>> dependency_versions();

}  // namespace nscdd
