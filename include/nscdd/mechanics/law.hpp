// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/local_contact.hpp>

#include <string_view>
#include <variant>

namespace nscdd {

/// Linear interaction law r = -v / epsilon ([ADI12] eq. (9)); epsilon = 0 is the rigid limit v = 0.
/// epsilon is a flexibility, 1/kg (inverse of an integral viscosity, the paper's 1/k).
struct LinearViscous {
  static constexpr std::string_view name = "linear_viscous";
  static constexpr bool opens = false, rubs = true, pulls = false;
  double epsilon = 1.0;

  static LinearViscous of(const auto& interaction, double /*h*/) { return {interaction.epsilon}; }
  double pull() const { return 0; }

  double flexibility() const { return epsilon; }

  /// Impulse of one contact: solves v = free_velocity + delassus r together with the law; delassus > 0.
  double impulse(double free_velocity, double delassus) const { return -free_velocity / (delassus + epsilon); }

  /// The same of a contact with both components, as Coulomb::impulse.
  template <class Delassus>
  LocalVector impulse(LocalVector stop, const Delassus& w, double /*friction*/) const {
    return w.soften(stop, epsilon);
  }
};

/// Laws of the linear study: one file and one word here per law. A law has
///   impulse(free_velocity, delassus)  of one contact, with v = free_velocity + delassus r; a sweep needs it
///   flexibility()                     of its linear (or linearised) form, 1/kg; S = X_epsilon needs it
using Law = std::variant<LinearViscous>;

inline double flexibility(const Law& law) {
  return std::visit([](const auto& one) { return one.flexibility(); }, law);
}

}  // namespace nscdd
