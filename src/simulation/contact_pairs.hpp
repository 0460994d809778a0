// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/granular_system.hpp"

namespace nscdd {

/// A colour of grains first ... last of the packing, as a case file gives it ([[colour]]). Several may have one name.
struct ColourSpec {
  std::string name;
  Index first = 0, last = -1;  ///< negative from the end
};

/// Rules for contacts of two colours ([[pair]]).
struct PairSpec {
  std::array<std::string, 2> colours;
  PairRule rule = {};
};

/// Sets colours and rules of a system whose first `grains` are those of a packing. `of_boundaries`: the colour of each
/// boundary, "" for none. Throws Error for an impossible range of grains, a colour of nothing, and a pair given twice.
void set_pairs(GranularSystem& system, const std::vector<ColourSpec>& colours, const std::vector<PairSpec>& pairs,
               const std::vector<std::string>& of_boundaries, Index grains);

/// Its lines in a case file.
std::string to_toml(const ColourSpec& spec);
std::string to_toml(const PairSpec& spec);

}  // namespace nscdd
