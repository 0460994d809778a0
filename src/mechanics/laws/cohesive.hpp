// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/laws/coulomb.hpp"

namespace nscdd {

/// Coulomb's law of grains that stick together: a contact that touches pulls with up to `cohesion` before it opens,
///     0 <= v_n,  0 <= r_n + cohesion,  v_n (r_n + cohesion) = 0,  |r_t| <= friction (r_n + cohesion);
/// one that does not has cohesion 0 (see `hold`). It is Coulomb's law at a shifted impulse.
struct Cohesive {
  static constexpr std::string_view name = "cohesive";
  static constexpr bool opens = true, rubs = true, pulls = true;
  double cohesion = 0;  ///< largest pulling impulse, N s: the force times the time step

  static Cohesive of(const auto& interaction, double h, double /*scale*/) { return {h * interaction.cohesion}; }
  double pull() const { return cohesion; }

  /// As Coulomb::impulse.
  template <int D, class Delassus>
  LocalVector<D> impulse(LocalVector<D> stop, const Delassus& w, double friction) const {
    const LocalVector<D> shifted = Coulomb{}.impulse(LocalVector<D>{stop.n + cohesion, stop.t}, w, friction);
    return {shifted.n - cohesion, shifted.t};
  }
};

}  // namespace nscdd
