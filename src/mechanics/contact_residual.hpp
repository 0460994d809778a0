// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/impulse_scale.hpp"

namespace nscdd {

/// How well impulses and velocities obey the contact law: sums over contacts, so that subdomains add up.
struct ContactResidual {
  double natural_map = 0;     ///< |natural map|^2 with rho = 1/W_nn of each contact, (N s)^2
  double impulses = 0;        ///< |r|^2, (N s)^2, with a law that pulls |r + pull n|^2
  double violation = 0;       ///< |W_c (r_c' - r_c)|^2, r_c' the law's answer now; SumDVDV of LMGC90, (m/s)^2
  double work = 0;            ///< (r_c' + r_c)/2 . W_c (r_c' - r_c); SumDVoR of LMGC90, J
  double scale_work = 0;      ///< mean of r_c . W_c r_c and r_c' . W_c r_c'; SumWRR of LMGC90, J
  double scale_velocity = 0;  ///< mean of |W_c r_c|^2 and |W_c r_c'|^2; SumWRWR of LMGC90, (m/s)^2
  Index active = 0;           ///< contacts with an impulse
  Index stick = 0, slide = 0;
  ImpulseScale scale = {};  ///< of the step; `+=` leaves it

  ContactResidual& operator+=(const ContactResidual& other);

  /// |natural map| / natural_map_scale: error of the contact law in the form of De Saxce; 0 if the natural map is 0.
  double relative_natural_map() const;
  /// LMGC90's criteria "Quad /DV" and "mean DV over r", not divided by its tolerance. They are relative to W r and to
  /// r W r; rounding of the velocities is judged relative to `speeds` and `energies` instead.
  double quad_dv() const;
  double mean_dv_over_r() const;
};

/// Sums over the contacts at the velocities v. With a cohesive law the natural map is that of the shifted impulses,
/// with a viscous law r' - r.
template <int D>
ContactResidual contact_residual(const ContactLaw& law, const ContactRows<D>& contacts, GrainVelocities<D> v);
template <int D>
ContactResidual contact_residual(const ContactLaw& law, const std::vector<GrainContact<D>>& contacts,
                                 GrainVelocities<D> v);

/// Status of each contact under the law: open, stick or slide.
template <int D>
ContactStatus status_of(const ContactLaw& law, const GrainContact<D>& contact);

}  // namespace nscdd
