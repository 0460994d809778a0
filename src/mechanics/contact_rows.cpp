// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/sphere_sweep.hpp"

namespace nscdd {
namespace {

// The choices are template parameters, so that the loop does not make them again for every contact.
template <bool relaxed, bool tangential_bias, class Law>
SweepSums sweep(const Law& law, ContactRows<2>& contacts, std::span<GrainVelocity<2>> velocities, double relaxation) {
  SweepSums sums;
  GrainVelocity<2>* const v = velocities.data();
  const double frictions[2] = {contacts.friction, contacts.boundary_friction};
  const std::size_t n = contacts.size();
  for (std::size_t k = 0; k < n; ++k) {
    const ContactRow<2>& c = contacts.rows[k];
    LocalVector<2>& r = contacts.impulses[k];
    GrainVelocity<2>& a = v[c.a];
    GrainVelocity<2>& b = v[c.b];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double v_n = c.normal_x * dx + c.normal_y * dy + c.bias_n;
    double v_t = c.normal_x * dy - c.normal_y * dx - (a.rim + b.rim);
    if constexpr (tangential_bias) v_t += contacts.bias_t[k];
    const DiagonalDelassus w = grain_delassus(a, b);
    const bool driven = a.inverse_mass == 0 || b.inverse_mass == 0;
    const LocalVector<2> stop{r.n - w.inverse_n * v_n, r.t - w.inverse_t * v_t};
    LocalVector<2> next;
    if constexpr (Law::pulls)
      next = law_at(law, contacts.pull[k]).impulse(stop, w, frictions[driven]);
    else
      next = law.impulse(stop, w, frictions[driven]);
    // What follows is take_impulse and apply_impulse, number by number: GCC 12 packs pairs of numbers into
    // vector registers, and a sweep then takes 1.7 times as long.
    if constexpr (relaxed) {
      next.n = r.n + relaxation * (next.n - r.n);
      next.t = r.t + relaxation * (next.t - r.t);
    }
    const double change_n = next.n - r.n, change_t = next.t - r.t;
    r = next;
    const double px = c.normal_x * change_n - c.normal_y * change_t;
    const double py = c.normal_y * change_n + c.normal_x * change_t;
    a.x -= a.inverse_mass * px;
    a.y -= a.inverse_mass * py;
    a.rim -= rim_mass_ratio<2> * a.inverse_mass * change_t;
    b.x += b.inverse_mass * px;
    b.y += b.inverse_mass * py;
    b.rim -= rim_mass_ratio<2> * b.inverse_mass * change_t;
    sums.change += change_n * change_n + change_t * change_t;
    sums.impulses += next.n * next.n + next.t * next.t;
  }
  return sums;
}

template <bool relaxed, bool tangential_bias, class Law>
SweepSums sweep(const Law& law, ContactRows<3>& contacts, std::span<GrainVelocity<3>> velocities, double relaxation) {
  return sweep_spheres<relaxed, tangential_bias>(law, contacts, velocities, relaxation);
}

}  // namespace

template <int D>
GrainContact<D> ContactRows<D>::contact(std::size_t k, std::span<const GrainVelocity<D>> v) const {
  const ContactRow<D>& row = rows[k];
  const GrainVelocity<D>& a = v[static_cast<std::size_t>(row.a)];
  const GrainVelocity<D>& b = v[static_cast<std::size_t>(row.b)];
  return {.a = row.a,
          .b = row.b,
          .normal = row.normal(),
          .inverse_w = grain_delassus(a, b),
          .bias = bias_t.empty() ? LocalVector<D>{row.bias_n, {}}
                                 : in_frame(row.normal(), SweptVector<D>{row.bias_n, bias_t[k]}),
          .friction = a.inverse_mass == 0 || b.inverse_mass == 0 ? boundary_friction : friction,
          .pull = pull.empty() ? 0.0 : pull[k],
          .impulse = impulse(k)};
}

template <int D>
SweepSums gauss_seidel_sweep(const ContactLaw& law, ContactRows<D>& contacts,
                             std::type_identity_t<std::span<GrainVelocity<D>>> v, double relaxation) {
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

template struct ContactRows<2>;
template struct ContactRows<3>;
template SweepSums gauss_seidel_sweep(const ContactLaw&, ContactRows<2>&, std::span<GrainVelocity<2>>, double);
template SweepSums gauss_seidel_sweep(const ContactLaw&, ContactRows<3>&, std::span<GrainVelocity<3>>, double);

}  // namespace nscdd
