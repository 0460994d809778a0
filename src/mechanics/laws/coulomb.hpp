// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/cone_contact.hpp"

namespace nscdd {

/// Unilateral contact with Coulomb friction at velocity level:  0 <= v_n, 0 <= r_n, v_n r_n = 0 and
/// |r_t| <= friction r_n, opposite to v_t where equal.
struct Coulomb {
  static constexpr std::string_view name = "coulomb";
  static constexpr bool opens = true, rubs = true, pulls = false;

  static Coulomb of(const auto& /*interaction*/, double /*h*/, double /*scale*/) { return {}; }
  double pull() const { return 0; }

  /// Solves v = W (r - stop) together with the law, exactly. `stop` = r - W^-1 v of the present state is the
  /// impulse that would bring the contact to rest, N s. A solution always exists. If W is coupled and
  /// friction > W_nn / |W_nt|, there may be several, one of them open, which is then returned. For a coupled W in
  /// space see ConeContact.
  template <int D, class Delassus>
  LocalVector<D> impulse(LocalVector<D> stop, const Delassus& w, double friction) const {
    if constexpr (Delassus::coupled && D == 3) {
      return ConeContact(w).impulse(w.apply(-1.0 * stop), friction);
    } else if constexpr (Delassus::coupled) {
      const LocalVector<D> free = w.apply(LocalVector<D>{-stop.n, -stop.t});
      if (free.n >= 0) return {};
      if (std::abs(stop.t) <= friction * stop.n) return stop;
      // v_n = 0 holds on the line W_nn r_n + W_nt r_t = -free_n, which meets the cone at r_t = 0 and leaves it for
      // `stop` through the edge on its side, with the velocity against the impulse: that crossing always exists, and is
      // the one solution. (No test of v_t: rounding must not open a contact that just slips.)
      const double slope = std::copysign(friction, stop.t);
      const double n = std::max(0.0, -free.n / (w.nn + slope * w.nt));
      return {n, slope * n};
    } else {
      const double n = std::max(0.0, stop.n);
      return {n, projected_on_disk(stop.t, friction * n)};
    }
  }
};

}  // namespace nscdd
