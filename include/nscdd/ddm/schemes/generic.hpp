// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <string_view>

namespace nscdd {

/// Stage 2 of the generic algorithm ([ADI12] Algorithm 1): X F' = f + sum_E A_E M_E^-1 H_E r_E, inertia only.
struct Generic {
  static constexpr std::string_view name = "generic";
  double flexibility() const { return infinity; }  ///< of the network that Stage 2 sees: no network
};

}  // namespace nscdd
