// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/local_contact.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace nscdd {

/// Unilateral contact with Coulomb friction at velocity level:  0 <= v_n, 0 <= r_n, v_n r_n = 0 and
/// |r_t| <= friction r_n, opposite to v_t where equal.
struct Coulomb {
  static constexpr std::string_view name = "coulomb";

  /// Solves v = W (r - stop) together with the law, exactly: open, stick or slide. `stop` = r - W^-1 v of the
  /// present state is the impulse that would bring the contact to rest, N s.
  /// W coupled and friction large may admit several solutions (open is preferred, then stick) or none (then
  /// the contact opens).
  template <class Delassus>
  LocalVector impulse(LocalVector stop, const Delassus& w, double friction) const {
    if constexpr (Delassus::coupled) {
      const LocalVector free = w.apply({-stop.n, -stop.t});
      if (free.n >= 0) return {};
      if (std::abs(stop.t) <= friction * stop.n) return stop;
      return slide(free, w, stop.t < 0 ? -friction : friction);
    } else {
      const double n = std::max(0.0, stop.n);
      return {n, std::max(-friction * n, std::min(friction * n, stop.t))};
    }
  }

 private:
  // v_n = 0 with the impulse along (1, s), s = +-friction: the sign asked for first, then the other.
  static LocalVector slide(LocalVector free, const FullDelassus& w, double s) {
    for (const double slope : {s, -s}) {
      const double n = -free.n / (w.nn + slope * w.nt);
      const double v_t = free.t + (w.nt + slope * w.tt) * n;
      if (n > 0 && slope * v_t <= 0) return {n, slope * n};
    }
    return {};
  }
};

}  // namespace nscdd
