// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>
#include <nscdd/core/types.hpp>

#include <string_view>

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

}  // namespace nscdd
