// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>
#include <nscdd/core/types.hpp>

#include <variant>

namespace nscdd {

/// Relative velocity or impulse of one contact in its frame (n, t), t = n turned by +90 degrees: n > 0
/// separates (velocity, m/s) or presses (impulse, N s).
struct LocalVector {
  double n = 0, t = 0;
};
inline LocalVector operator+(LocalVector a, LocalVector b) { return {a.n + b.n, a.t + b.t}; }
inline LocalVector operator-(LocalVector a, LocalVector b) { return {a.n - b.n, a.t - b.t}; }
inline LocalVector operator*(double factor, LocalVector a) { return {factor * a.n, factor * a.t}; }
inline double dot(LocalVector a, LocalVector b) { return a.n * b.n + a.t * b.t; }
inline double squared(LocalVector a) { return dot(a, a); }

/// Status of a contact with Coulomb friction. Open: r = 0. Stick: v = 0, the impulse inside the cone. Slide:
/// v_n = 0 and r_t = -friction r_n (forward, v_t >= 0) or +friction r_n (backward, v_t <= 0).
enum class ContactStatus : signed char { open, stick, slide_forward, slide_backward };

constexpr auto names_of(ContactStatus) {
  return std::to_array<std::string_view>({"open", "stick", "slide_forward", "slide_backward"});
}

/// The diagonal block W_c of the Delassus operator of one contact, s.p.d. 2 x 2, 1/kg. Of two disks it is
/// diagonal, for the contact point lies on the line of centres: normal impulses cause no spin.
struct DiagonalDelassus {
  static constexpr bool coupled = false;
  double inverse_n = 0, inverse_t = 0;  ///< 1/W_nn, 1/W_tt, kg

  LocalVector apply(LocalVector r) const { return {r.n / inverse_n, r.t / inverse_t}; }
  LocalVector solve(LocalVector v) const { return {inverse_n * v.n, inverse_t * v.t}; }
  /// (W + epsilon I)^-1 W r
  LocalVector soften(LocalVector r, double epsilon) const {
    return {r.n / (1 + epsilon * inverse_n), r.t / (1 + epsilon * inverse_t)};
  }
};

/// The block of bodies of any other shape.
struct FullDelassus {
  static constexpr bool coupled = true;
  double nn = 0, nt = 0, tt = 0;

  LocalVector apply(LocalVector r) const { return {nn * r.n + nt * r.t, nt * r.n + tt * r.t}; }
  LocalVector solve(LocalVector v) const {
    const double determinant = nn * tt - nt * nt;
    return {(tt * v.n - nt * v.t) / determinant, (nn * v.t - nt * v.n) / determinant};
  }
  LocalVector soften(LocalVector r, double epsilon) const {
    return FullDelassus{nn + epsilon, nt, tt + epsilon}.solve(apply(r));
  }
};

/// Linear interaction law r = -v / epsilon ([ADI12] eq. (9)); epsilon = 0 is the rigid limit v = 0.
/// epsilon is a flexibility, 1/kg (inverse of an integral viscosity, the paper's 1/k).
struct LinearViscous {
  static constexpr std::string_view name = "linear_viscous";
  static constexpr bool opens = false, rubs = true, pulls = false;
  double epsilon = 1.0;

  static LinearViscous of(const auto& interaction, double /*h*/, double scale) {
    return {interaction.epsilon.at_scale(scale)};
  }
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
