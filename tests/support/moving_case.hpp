// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace nscdd::testing {

/// A case file: a deposit of 120 grains in a box of disks whose side walls turn about their feet, two
/// subdomains, generic algorithm with warm start. A step takes about a millisecond.
std::string moving_case();

/// The same of 30 grains and 12 steps.
std::string small_moving_case();

/// A case file: `packing` is the path of a file, or a generator with its parameters; `grid` a partition as "2, 1".
std::string case_text(const std::string& packing, const std::string& grid = "1, 1", const std::string& more = "");

/// A boundary of it: a wall in space, or in the plane through two points.
std::string wall_text(const std::string& name, const std::string& point, const std::string& normal,
                      const std::string& more = "");
std::string line_text(const std::string& name, const std::string& from, const std::string& to,
                      const std::string& more = "");

/// 27 spheres that fall into a drum which turns.
std::string drum_case();

}  // namespace nscdd::testing
