// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/laws/linear_viscous.hpp>

#include <variant>

namespace nscdd {

/// Laws of the linear study: one file and one word here per law. A law has
///   impulse(free_velocity, delassus)  the impulse r of one contact, solved together with v = free_velocity +
///                                     delassus r; a Gauss-Seidel sweep needs it
///   flexibility()                     of its linear (or linearised) form, 1/kg; S = X_epsilon needs it
using Law = std::variant<LinearViscous>;

inline double flexibility(const Law& law) {
  return std::visit([](const auto& one) { return one.flexibility(); }, law);
}

}  // namespace nscdd
