// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/law.hpp>

namespace nscdd {

/// One contact in space with a general symmetric positive definite block W and Coulomb's law, made ready once for many
/// right-hand sides: finds r with
///     v = W r + free,   0 <= v_n,  0 <= r_n,  v_n r_n = 0,   |r_t| <= friction r_n,  opposite to v_t where equal.
/// Where the contact slides, v_n = 0 and v_t = -lambda r_t leave
///     (S + lambda I) r_t = b,   r_n = -(free_n + W_nt . r_t) / W_nn,
///     S = W_tt - W_nt W_nt^T / W_nn,   b = W_nt free_n / W_nn - free_t,
/// and |r_t| = friction r_n, a quartic in lambda (O. Bonnefon and G. Daviet, Quartic formulation of Coulomb 3D
/// frictional contact, INRIA RT-0400, 2011), here in the principal axes of S. It is solved as friction r_n / |r_t| = 1,
/// whose left side is next to linear, by Newton's steps inside a bracket that each halves where they do not.
///
/// There is always a solution: the open one where free_n >= 0; else the one at rest if its impulse lies in the cone;
/// else lambda = 0 lies on one side of the equation and lambda -> infinity on the other. It is the only one if free_n <
/// 0 and friction |W_nt| / W_nn < 2 sqrt(k) / (1 + k), k the condition number of S. Otherwise there may be others, and
/// with free_n >= 0 if friction |W_nt| > W_nn; an open one is taken first, then one at rest, and of three that slide
/// the one to which the bracket shrinks.
class ConeContact {
 public:
  ConeContact() = default;
  explicit ConeContact(const FullDelassus<3>& w);

  /// `free`: v without an impulse of this contact, m/s. Numbers that are not finite give an impulse
  /// that is not, unless free_n >= 0 opens the contact.
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
