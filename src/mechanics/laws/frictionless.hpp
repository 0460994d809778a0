// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/laws/coulomb.hpp"

namespace nscdd {

/// Signorini's unilateral law at velocity level without friction:  0 <= v_n, 0 <= r_n, v_n r_n = 0, r_t = 0.
struct Frictionless {
  static constexpr std::string_view name = "frictionless";
  static constexpr bool opens = true, rubs = false, pulls = false;

  static Frictionless of(const auto& /*interaction*/, double /*h*/, double /*scale*/) { return {}; }
  double pull() const { return 0; }

  /// As Coulomb::impulse.
  template <int D, class Delassus>
  LocalVector<D> impulse(LocalVector<D> stop, const Delassus& w, double /*friction*/) const {
    return {Coulomb{}.impulse(stop, w, 0).n, {}};
  }
};

}  // namespace nscdd
