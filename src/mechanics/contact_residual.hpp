// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/grain_contacts.hpp"

namespace nscdd {

/// Scales of the impulses of a step, from the velocities without impulses: sums over contacts. r^1 is the impulse of a
/// contact while the others have none, s the sum of the speeds of its two bodies, rims included.
struct ImpulseScale {
  double alone = 0;     ///< |r^1|^2, (N s)^2
  double momenta = 0;   ///< p^2, the sum of (s/W_nn)^2, (N s)^2
  double speeds = 0;    ///< the sum of s^2, (m/s)^2
  double energies = 0;  ///< the sum of s^2/W_nn, J

  static constexpr double squared_rounding = 1e-24;  ///< squared impulses below this part of `momenta` are rounding
  /// max(|r^1|, p), N s: the velocities that impulses change are at most those of the bodies.
  double driving() const { return std::sqrt(std::max(alone, momenta)); }
};

/// Rounding of the velocities of a body, which are sums over its contacts, relative to the terms of these sums.
inline constexpr double rounding_of_sums = 1e-14;

/// The scale of natural maps of the norm `maps`, N s, for impulses of the norm `impulses` (docs/theory.md, section 7):
///     max(|r^1|, min(|r|, 10^5 max(|r^1|, p))).
/// Natural maps up to 10^-14 max(|r|, p) are rounding; their scale is max(|r|, |r^1|, p). `alone`: |r^1|; `momenta`: p.
/// With `squared` all four and the result are squares, (N s)^2. `believed`: impulses count as at most this in that
/// test, since impulses that grow without bound would make every natural map rounding.
double natural_map_scale(double maps, double impulses, double alone, double momenta, bool squared = false,
                         double believed = infinity);

/// The terms of a contact in the scale of a step, at the velocities V_free; `speeds`: speeds_of these.
template <int D>
ImpulseScale impulse_scale(const ContactLaw& law, const GrainContact<D>& c, GrainVelocities<D> free,
                           const std::vector<double>& speeds) {
  const double speed = speeds[at(c.a)] + speeds[at(c.b)];
  return with_delassus(c, [&](const auto& w) {
    const LocalVector<D> stop = -1.0 * w.solve(relative_velocity(c, free) + c.bias);
    const LocalVector<D> alone = law_impulse(law, c, stop, w);
    const double mass = w.inverse_normal();
    return ImpulseScale{.alone = squared(LocalVector<D>{alone.n + c.pull, alone.t}),
                        .momenta = speed * speed * mass * mass,
                        .speeds = speed * speed,
                        .energies = speed * speed * mass};
  });
}

/// How well impulses and velocities obey the contact law: sums over contacts, which add up over subdomains.
struct ContactResidual {
  double natural_map = 0;     ///< |natural map|^2 with rho = 1/W_nn of each contact, (N s)^2
  double impulses = 0;        ///< |r|^2, (N s)^2, with a law that pulls |r + pull n|^2
  double violation = 0;       ///< |W_c (r_c' - r_c)|^2, r_c' the law's impulse now; SumDVDV of LMGC90, (m/s)^2
  double work = 0;            ///< (r_c' + r_c)/2 . W_c (r_c' - r_c); SumDVoR of LMGC90, J
  double scale_work = 0;      ///< mean of r_c . W_c r_c and r_c' . W_c r_c'; SumWRR of LMGC90, J
  double scale_velocity = 0;  ///< mean of |W_c r_c|^2 and |W_c r_c'|^2; SumWRWR of LMGC90, (m/s)^2
  double squared_work = 0;    ///< |W_c (r_c' - r_c)|^2 |(r_c' + r_c)/2|^2; SumDVDVRR of LMGC90, J^2
  double largest_violation = 0, largest_squared_work = 0;  ///< terms of single contacts
  Index active = 0;                                        ///< contacts with an impulse
  Index stick = 0, slide = 0;
  Index loaded = 0;         ///< contacts whose (r_c' + r_c)/2 is not 0; Nactif of LMGC90
  ImpulseScale scale = {};  ///< of the step

  /// |natural map| / natural_map_scale: error of the contact law in the form of De Saxce; 0 if the natural map is 0.
  double relative_natural_map() const;
  /// LMGC90's criteria "Quad /DV", "Quad /DVR" and "mean DV over r", not divided by its tolerance. They are relative to
  /// W r and to r W r; rounding of the velocities is judged relative to `speeds` and `energies` instead.
  double quad_dv() const;
  double quad_dvr() const;
  double mean_dv_over_r() const;
  /// LMGC90's criterion "QM/16": the largest of |mean DV over r|, Quad/DV, Quad/DVR, and Maxm/DV and Maxm/DVR over
  /// 16.666, which have the largest term of a contact in place of the mean over the loaded ones.
  double qm_16() const;
};

/// Sums over the contacts. The natural map of a cohesive law is that of the shifted impulses, of a viscous law r' - r.
template <int D>
ContactResidual contact_residual(const ContactLaw& law, const ContactRows<D>& contacts, GrainVelocities<D> v);
template <int D>
ContactResidual contact_residual(const ContactLaw& law, const std::vector<GrainContact<D>>& contacts,
                                 GrainVelocities<D> v);

/// The status of a contact whose law opens.
template <int D>
ContactStatus status_in_cone(const GrainContact<D>& c) {
  constexpr double edge_tolerance = 1e-12;  // of the cone, for the rounding of sums of impulses
  return contact_status(LocalVector<D>{c.impulse.n + c.pull, c.impulse.t}, c.friction, edge_tolerance);
}
template <int D>
ContactStatus status_of(const ContactLaw& law, const GrainContact<D>& c) {
  return opens(law) ? status_in_cone(c) : ContactStatus::stick;
}

}  // namespace nscdd
