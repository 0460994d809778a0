// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/grain_contacts.hpp"

namespace nscdd {

/// A sweep over contacts of bodies of any shape, each with its own friction, see ContactRows::others. It is slower than
/// the sweeps over disks and spheres, which have no levers.
template <int D, class Law>
SweepSums general_sweep(const Law& law, ContactRows<D>& contacts, std::span<GrainVelocity<D>> v, double relaxation) {
  SweepSums sums;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const GrainContact<D> c = contacts.contact(k, v);
    LocalVector<D> next = with_delassus(c, [&](const auto& w) {
      const LocalVector<D> stop = c.impulse - w.solve(relative_velocity<D>(c, v) + c.bias);
      return law_at(law, c.pull).impulse(stop, w, c.friction);
    });
    if (relaxation != 1) next = c.impulse + relaxation * (next - c.impulse);
    const LocalVector<D> change = next - c.impulse;
    contacts.set_impulse(k, next);
    apply_impulse(c, change, v);
    sums.change += squared(change);
    sums.impulses += squared(next);
  }
  return sums;
}

}  // namespace nscdd
