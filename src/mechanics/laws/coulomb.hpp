// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/law.hpp>

namespace nscdd {

/// Coulomb's law of one contact in space, symmetric positive definite block W, many right-hand sides: finds r with
///     v = W r + free,   0 <= v_n,  0 <= r_n,  v_n r_n = 0,   |r_t| <= friction r_n,  opposite to v_t where equal.
/// Where the contact slides, v_n = 0 and v_t = -lambda r_t leave
///     (S + lambda I) r_t = b,   r_n = -(free_n + W_nt . r_t) / W_nn,
///     S = W_tt - W_nt W_nt^T / W_nn,   b = W_nt free_n / W_nn - free_t,
/// and |r_t| = friction r_n, a quartic in lambda (O. Bonnefon and G. Daviet, Quartic formulation of Coulomb 3D
/// frictional contact, INRIA RT-0400, 2011), here in the principal axes of S. It is solved as friction r_n / |r_t| = 1,
/// whose left side is nearly linear, by Newton's method; bisection replaces steps that leave the bracket.
///
/// A solution always exists: open if free_n >= 0; else at rest if that impulse lies in the cone; else a root between
/// lambda = 0 and lambda -> infinity, where the equation changes sign. It is unique if free_n < 0 and
/// friction |W_nt| / W_nn < 2 sqrt(k) / (1 + k), with the condition number k of S. Otherwise, and for free_n >= 0 if
/// friction |W_nt| > W_nn, there may be several: open, else rest, else sliding; of three sliding ones the bracket's.
class ConeContact {
 public:
  ConeContact() = default;
  explicit ConeContact(const FullDelassus<3>& w);

  /// `free`: v without an impulse of this contact, m/s. If not finite, so is the impulse, unless free_n >= 0.
  LocalVector<3> impulse(LocalVector<3> free, double friction) const;

 private:
  TangentVector rotated(TangentVector a) const {
    return {cos_ * a.first + sin_ * a.second, cos_ * a.second - sin_ * a.first};
  }
  TangentVector back(TangentVector a) const {
    return {cos_ * a.first - sin_ * a.second, cos_ * a.second + sin_ * a.first};
  }
  LocalVector<3> sliding(LocalVector<3> free, TangentVector b, double friction) const;

  double inverse_n_ = 0;      // 1 / W_nn
  TangentVector coupling_;    // W_nt / W_nn, in the principal axes of S
  TangentVector stiffness_;   // principal values of S, the larger one first
  double cos_ = 1, sin_ = 0;  // of the first axis
};

/// Unilateral contact with Coulomb friction at velocity level:  0 <= v_n, 0 <= r_n, v_n r_n = 0 and
/// |r_t| <= friction r_n, opposite to v_t where equal.
struct Coulomb {
  static constexpr std::string_view name = "coulomb";
  static constexpr bool opens = true, rubs = true, pulls = false;

  static Coulomb of(const auto& /*interaction*/, double /*h*/, double /*scale*/) { return {}; }
  double pull() const { return 0; }

  /// Solves v = W (r - stop) together with the law, exactly. `stop` = r - W^-1 v of the present state is the impulse
  /// that would bring the contact to rest, N s. A solution always exists. If W is coupled and friction > W_nn / |W_nt|,
  /// there may be several, one of them open, which is then returned. For a coupled W in space see ConeContact.
  template <int D, class Delassus>
  LocalVector<D> impulse(LocalVector<D> stop, const Delassus& w, double friction) const {
    if constexpr (Delassus::coupled && D == 3) {
      const LocalVector<3> free = w.apply(-1.0 * stop);
      if (friction > 0 && free.n < 0) return ConeContact(w).impulse(free, friction);
      return {std::max(0.0, -free.n) / w.nn, {}};  // without the principal axes of W
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
