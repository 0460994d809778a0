// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/law.hpp>

namespace nscdd {

/// Coulomb's law of one contact in space with a general symmetric positive definite block W, for many right-hand sides:
/// finds r with
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
/// friction |W_nt| > W_nn, there may be several: open is preferred to rest, and rest to sliding; of three sliding ones
/// the bracket selects one.
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

}  // namespace nscdd
