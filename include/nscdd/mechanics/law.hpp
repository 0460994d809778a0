// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/laws/linear_viscous.hpp>

#include <variant>

namespace nscdd {

/// Interaction laws between two grains: one file and one word here per law. A law has
///   impulse(free_velocity, delassus)  the impulse of one contact, solved together with v = free + delassus
///   r,
///                                     which is what a Gauss-Seidel sweep asks;
///   flexibility()                     of its linear (or linearised) form, kg^-1, which is what S = X_epsilon
///   asks.
using Law = std::variant<LinearViscous>;

inline double flexibility(const Law& law) {
  return std::visit([](const auto& one) { return one.flexibility(); }, law);
}

}  // namespace nscdd
