// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/law.hpp>

#include <algorithm>
#include <string_view>

namespace nscdd {

/// Signorini's unilateral law at velocity level without friction:  0 <= v_n, 0 <= r_n, v_n r_n = 0, r_t = 0.
struct Frictionless {
  static constexpr std::string_view name = "frictionless";
  static constexpr bool opens = true, rubs = false, pulls = false;

  static Frictionless of(const auto& /*interaction*/, double /*h*/) { return {}; }
  double pull() const { return 0; }

  /// Solves v = W (r - stop) together with the law. `stop` = r - W^-1 v of the present state is the impulse
  /// that would bring the contact to rest, N s.
  template <class Delassus>
  LocalVector impulse(LocalVector stop, const Delassus& w, double /*friction*/) const {
    if constexpr (Delassus::coupled)
      return {std::max(0.0, w.apply(stop).n / w.nn), 0.0};  // v_n = W_nn r_n - (W stop)_n
    else
      return {std::max(0.0, stop.n), 0.0};
  }
};

}  // namespace nscdd
