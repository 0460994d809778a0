// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

#include <string>
#include <string_view>

namespace nscdd {

/// Packing from CSV text with columns x, y, radius (m) and optionally mass (kg), in any order.
/// Throws Error "name:line: ..." for a missing, unknown or repeated column, a value that is no number, not
/// finite, or not positive where it must be, and for a file without grains.
Packing parse_packing(std::string_view text, const std::string& name);

/// The same from a file.
Packing read_packing(const std::string& path);

}  // namespace nscdd
