// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/grain_contacts.hpp"

namespace nscdd {

/// What drives the contacts of a step, before any impulse acts: sums over contacts. r^1 is the impulse that a contact
/// takes while the others have none, s the sum of the speeds of its two bodies, rims included.
struct ImpulseScale {
  double alone = 0;     ///< |r^1|^2, (N s)^2
  double momenta = 0;   ///< p^2, the sum of (s/W_nn)^2, (N s)^2
  double speeds = 0;    ///< the sum of s^2, (m/s)^2
  double energies = 0;  ///< the sum of s^2/W_nn, J

  /// Squared impulses below this part of `momenta` are rounding.
  static constexpr double squared_rounding = 1e-24;
  /// max(|r^1|, p), N s: velocities that impulses must change are no larger than those of the bodies.
  double driving() const { return std::sqrt(std::max(alone, momenta)); }
};

/// Rounding of the velocities of a body, which are sums over its contacts, relative to the terms of these sums.
inline constexpr double rounding_of_sums = 1e-14;

/// The scale of natural maps of the norm `maps`, N s, for impulses of the norm `impulses` (docs/theory.md, section 7):
///     max(|r^1|, min(|r|, 10^5 max(|r^1|, p))).
/// Natural maps up to 10^-14 max(|r|, p) are rounding. They are measured against max(|r|, |r^1|, p).
/// `alone`: |r^1|; `momenta`: p. With `squared` all four and the result are squares, (N s)^2. `believed`: above this
/// norm of the impulses no natural map counts as rounding, since impulses may have grown until everything is rounding.
double natural_map_scale(double maps, double impulses, double alone, double momenta, bool squared = false,
                         double believed = infinity);

/// Sum of the speeds of both bodies of a contact, rims included, m/s.
template <int D>
double meeting_speed(const GrainContact<D>& contact, GrainVelocities<D> v);

/// What a contact adds to the scale of its step, at the velocities V_free.
template <int D>
ImpulseScale impulse_scale(const ContactLaw& law, const GrainContact<D>& contact, GrainVelocities<D> free);

}  // namespace nscdd
