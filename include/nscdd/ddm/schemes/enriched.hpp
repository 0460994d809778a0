// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace nscdd {

/// Stage 2 of the enriched algorithm ([ADI12] eqs. (15)-(17)): X_eta, the interface operator of the contact
/// network taken as links of flexibility eta > 0, 1/kg; eta = infinity is the generic algorithm.
struct Enriched {
  static constexpr std::string_view name = "enriched";
  double eta = 1.0;
  double flexibility() const { return eta; }
};

}  // namespace nscdd
