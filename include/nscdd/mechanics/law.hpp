// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>

namespace nscdd {

/// Two components in the tangent plane of a contact in space, along its tangents t_1 and t_2.
struct TangentVector {
  double first = 0, second = 0;
};
inline TangentVector operator+(TangentVector a, TangentVector b) { return {a.first + b.first, a.second + b.second}; }
inline TangentVector operator-(TangentVector a, TangentVector b) { return {a.first - b.first, a.second - b.second}; }
inline TangentVector operator-(TangentVector a) { return {-a.first, -a.second}; }
inline TangentVector operator*(double factor, TangentVector a) { return {factor * a.first, factor * a.second}; }
inline TangentVector operator/(TangentVector a, double divisor) { return (1 / divisor) * a; }
inline double dot(TangentVector a, TangentVector b) { return a.first * b.first + a.second * b.second; }
inline double norm(TangentVector a) { return std::hypot(a.first, a.second); }
/// The nearest point of the disk of that radius >= 0.
inline TangentVector projected_on_disk(TangentVector a, double radius) {
  const double size = norm(a);
  return size <= radius ? a : (radius / size) * a;
}

/// The same of a contact in the plane, which has one tangent.
inline double dot(double a, double b) { return a * b; }
inline double norm(double a) { return std::abs(a); }
inline double projected_on_disk(double a, double radius) { return std::max(-radius, std::min(radius, a)); }

/// The tangential part of a vector of a contact: a number in the plane (dimension D = 2), two in space (D = 3).
template <int D>
using Tangent = std::conditional_t<D == 2, double, TangentVector>;

/// Relative velocity or impulse of one contact in its frame, n > 0 separates (velocity, m/s) or presses (impulse, N s).
/// The frame is (n, t) in the plane, t = n turned by +90 degrees, and (n, t_1, t_2) in space.
template <int D>
struct LocalVector {
  double n = 0;
  Tangent<D> t{};

  friend LocalVector operator+(LocalVector a, LocalVector b) { return {a.n + b.n, a.t + b.t}; }
  friend LocalVector operator-(LocalVector a, LocalVector b) { return {a.n - b.n, a.t - b.t}; }
  friend LocalVector operator*(double factor, LocalVector a) { return {factor * a.n, factor * a.t}; }
  friend double dot(LocalVector a, LocalVector b) { return a.n * b.n + dot(a.t, b.t); }
  friend double squared(LocalVector a) { return dot(a, a); }
};

/// Whether it is not 0 (its square may underflow).
inline bool carries(const LocalVector<2>& r) { return r.n != 0 || r.t != 0; }
inline bool carries(const LocalVector<3>& r) { return r.n != 0 || r.t.first != 0 || r.t.second != 0; }

/// Status of a contact with Coulomb friction. Open: r = 0. Stick: v = 0, the impulse inside the cone. Slide: v_n = 0
/// and |r_t| = friction r_n against the velocity. In the plane r_t = -friction r_n (forward, v_t >= 0) or +friction r_n
/// (backward, v_t <= 0); in space the impulse gives the direction.
enum class ContactStatus : signed char { open, stick, slide_forward, slide_backward, slide };

constexpr auto names_of(ContactStatus) {
  return std::to_array<std::string_view>({"open", "stick", "slide_forward", "slide_backward", "slide"});
}

constexpr bool slides(ContactStatus status) { return status > ContactStatus::stick; }

/// The diagonal block W_c of the Delassus operator of one contact, symmetric and positive definite, 1/kg. For two disks
/// or spheres it is diagonal, since the contact point lies on the line of centres: normal impulses cause no spin. In
/// space W_tt is the same in all tangential directions.
struct DiagonalDelassus {
  static constexpr bool coupled = false;
  double inverse_n = 0, inverse_t = 0;  ///< 1/W_nn, 1/W_tt, kg

  double inverse_normal() const { return inverse_n; }
  template <int D>
  LocalVector<D> apply(LocalVector<D> r) const {
    return {r.n / inverse_n, r.t / inverse_t};
  }
  template <int D>
  LocalVector<D> solve(LocalVector<D> v) const {
    return {inverse_n * v.n, inverse_t * v.t};
  }
  /// (W + epsilon I)^-1 W r
  template <int D>
  LocalVector<D> soften(LocalVector<D> r, double epsilon) const {
    return {r.n / (1 + epsilon * inverse_n), r.t / (1 + epsilon * inverse_t)};
  }
};

/// A symmetric matrix of the tangent plane of a contact in space, [first mixed; mixed second].
struct TangentMatrix {
  double first = 0, mixed = 0, second = 0;
};
inline TangentVector operator*(const TangentMatrix& m, TangentVector a) {
  return {m.first * a.first + m.mixed * a.second, m.mixed * a.first + m.second * a.second};
}

/// The block W_c of bodies of any shape: W_nn, the coupling W_nt, and W_tt.
template <int D>
struct FullDelassus {
  static constexpr bool coupled = true;
  double nn = 0;
  Tangent<D> nt{};
  std::conditional_t<D == 2, double, TangentMatrix> tt{};

  double inverse_normal() const { return 1 / nn; }
  LocalVector<D> apply(LocalVector<D> r) const { return {nn * r.n + dot(nt, r.t), r.n * nt + tt * r.t}; }
  LocalVector<D> solve(LocalVector<D> v) const {
    if constexpr (D == 2) {
      const double determinant = nn * tt - nt * nt;
      return {(tt * v.n - nt * v.t) / determinant, (nn * v.t - nt * v.n) / determinant};
    } else {  // eliminates the normal component first
      const TangentVector over = nt / nn, rest = v.t - v.n * over;
      const TangentMatrix s = schur_complement();
      const double lower = s.mixed / s.first, second = s.second - s.mixed * lower;
      const double t2 = (rest.second - lower * rest.first) / second;
      const TangentVector t{(rest.first - s.mixed * t2) / s.first, t2};
      return {v.n / nn - dot(over, t), t};
    }
  }
  /// W_tt - W_nt W_nt^T / W_nn: change of v_t by a tangential impulse at constant v_n.
  TangentMatrix schur_complement() const requires(D == 3) {
    const TangentVector over = nt / nn;
    return {tt.first - nt.first * over.first, tt.mixed - nt.first * over.second, tt.second - nt.second * over.second};
  }
  LocalVector<D> soften(LocalVector<D> r, double epsilon) const {
    FullDelassus softer = *this;
    softer.nn += epsilon;
    if constexpr (D == 2) {
      softer.tt += epsilon;
    } else {
      softer.tt.first += epsilon;
      softer.tt.second += epsilon;
    }
    return softer.solve(apply(r));
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

  /// The same with both components, as Coulomb::impulse.
  template <int D, class Delassus>
  LocalVector<D> impulse(LocalVector<D> stop, const Delassus& w, double /*friction*/) const {
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
