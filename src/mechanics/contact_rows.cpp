// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/gauss_seidel.hpp"
#include <nscdd/mechanics/contact_rows.hpp>

namespace nscdd {
namespace {

// The choices are template parameters, so that the loop does not make them again for every contact.
template <bool relaxed, bool tangential_bias, class Law>
SweepSums sweep(const Law& law, ContactRows& contacts, std::span<DiskVelocity> velocities,
                double relaxation) {
  SweepSums sums;
  DiskVelocity* const v = velocities.data();
  const double frictions[2] = {contacts.friction, contacts.boundary_friction};
  const std::size_t n = contacts.size();
  for (std::size_t k = 0; k < n; ++k) {
    const ContactRows::Row& c = contacts.rows[k];
    LocalVector& r = contacts.impulses[k];
    DiskVelocity& a = v[c.a];
    DiskVelocity& b = v[c.b];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double v_n = c.normal_x * dx + c.normal_y * dy + c.bias_n;
    double v_t = c.normal_x * dy - c.normal_y * dx - (a.rim + b.rim);
    if constexpr (tangential_bias) v_t += contacts.bias_t[k];
    const DiagonalDelassus w = disk_delassus(a, b);
    const bool driven = a.inverse_mass == 0 || b.inverse_mass == 0;
    const LocalVector stop{r.n - w.inverse_n * v_n, r.t - w.inverse_t * v_t};
    LocalVector next;
    if constexpr (Law::pulls)
      next = law_at(law, contacts.pull[k]).impulse(stop, w, frictions[driven]);
    else
      next = law.impulse(stop, w, frictions[driven]);
    const LocalVector change = take_impulse<relaxed>(r, next, relaxation);
    sums.change += squared(change);
    sums.impulses += squared(r);
    apply_impulse(c, change, a, b);
  }
  return sums;
}

}  // namespace

DiskContact ContactRows::contact(std::size_t k, std::span<const DiskVelocity> v) const {
  const Row& row = rows[k];
  const DiskVelocity& a = v[static_cast<std::size_t>(row.a)];
  const DiskVelocity& b = v[static_cast<std::size_t>(row.b)];
  DiskContact c;
  c.a = row.a;
  c.b = row.b;
  c.normal_x = row.normal_x;
  c.normal_y = row.normal_y;
  c.inverse_w = disk_delassus(a, b);
  c.bias_n = row.bias_n;
  c.bias_t = bias_t.empty() ? 0.0 : bias_t[k];
  c.pull = pull.empty() ? 0.0 : pull[k];
  c.friction = a.inverse_mass == 0 || b.inverse_mass == 0 ? boundary_friction : friction;
  c.impulse_n = impulses[k].n;
  c.impulse_t = impulses[k].t;
  return c;
}

SweepSums gauss_seidel_sweep(const ContactLaw& law, ContactRows& contacts, std::span<DiskVelocity> v,
                             double relaxation) {
  return std::visit(
      [&](const auto& one) {
        const bool biased = !contacts.bias_t.empty();
        if (relaxation == 1)
          return biased ? sweep<false, true>(one, contacts, v, relaxation)
                        : sweep<false, false>(one, contacts, v, relaxation);
        return biased ? sweep<true, true>(one, contacts, v, relaxation)
                      : sweep<true, false>(one, contacts, v, relaxation);
      },
      law);
}

}  // namespace nscdd
