// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/grain_contacts.hpp"

namespace nscdd {

/// A sweep over contacts of bodies of any shape, each with its own friction, see ContactRows::others. It is slower than
/// the sweeps over disks and spheres, which have no levers.
template <int D, class Law>
SweepSums general_sweep(const Law& law, ContactRows<D>& contacts, std::span<GrainVelocity<D>> v, double relaxation) {
  SweepSums sums;
  const auto next_of = [&](std::size_t k, const LocalVector<D>& r, const auto& w) {
    LocalVector<D> u = contacts.relative_velocity_at(k, v);
    u.n += contacts.rows[k].bias_n;
    if (!contacts.bias_t.empty()) u = u + in_frame(contacts.rows[k].normal, SweptVector<D>{0, contacts.bias_t[k]});
    const double pull = contacts.pull.empty() ? 0 : contacts.pull[k];
    return law_at(law, pull).impulse(r - w.solve(u), w, contacts.others[k].friction);
  };
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const double mass_a = v[at(contacts.rows[k].a)].inverse_mass;
    const double mass_b = v[at(contacts.rows[k].b)].inverse_mass;
    const LocalVector<D> r = contacts.impulse(k);
    const Levers<D>* const levers = contacts.levers(k);
    LocalVector<D> next = levers == nullptr ? next_of(k, r, grain_delassus<D>(mass_a, mass_b))
                                            : next_of(k, r, lever_delassus(*levers, mass_a, mass_b));
    if (relaxation != 1) next = r + relaxation * (next - r);
    const LocalVector<D> change = next - r;
    contacts.set_impulse(k, next);
    contacts.push_bodies(k, change, v);
    sums.change += squared(change);
    sums.impulses += squared(next);
  }
  return sums;
}

}  // namespace nscdd
