// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/contact_frame.hpp"
#include "mechanics/contact_law.hpp"

namespace nscdd {

/// Velocity of a grain while a step is solved, a disk in the plane (D = 2) or a sphere in space (D = 3). The speed of
/// the rim, radius x angular velocity, stands for the spin: its inertia is mass/2 for a full disk and 2 mass/5 for a
/// full sphere, for any radius, and contacts need no lever arm.
template <int D>
struct GrainVelocity;
template <>
struct GrainVelocity<2> {
  double x = 0, y = 0, rim = 0;  ///< m/s
  double inverse_mass = 0;       ///< 1/kg; 0 for a body whose motion is prescribed
};
/// On its own cache line: a sweep visits grains in random order.
template <>
struct alignas(64) GrainVelocity<3> {
  double x = 0, y = 0, z = 0, rim_x = 0, rim_y = 0, rim_z = 0;  ///< m/s
  double inverse_mass = 0;                                      ///< 1/kg
};

/// Unknowns of a grain: its velocity and the speed of its rim, (x, y, rim) or (x, y, z, rim_x, rim_y, rim_z).
template <int D>
inline constexpr Index unknowns_of_grain = D == 2 ? 3 : 6;
template <int D>
using GrainUnknowns = std::array<double, at(unknowns_of_grain<D>)>;

/// Mass over inertia in the speed of the rim: 2 of a full disk, 5/2 of a full sphere.
template <int D>
inline constexpr double rim_mass_ratio = D == 2 ? 2.0 : 2.5;

/// Velocities as an argument from which D is not deduced.
template <int D>
using GrainVelocities = std::type_identity_t<std::span<const GrainVelocity<D>>>;

inline GrainUnknowns<2> unknowns(const GrainVelocity<2>& v) { return {v.x, v.y, v.rim}; }
inline GrainUnknowns<3> unknowns(const GrainVelocity<3>& v) { return {v.x, v.y, v.z, v.rim_x, v.rim_y, v.rim_z}; }
inline GrainVelocity<2> with_unknowns(const GrainUnknowns<2>& u, double inverse_mass) {
  return {u[0], u[1], u[2], inverse_mass};
}
inline GrainVelocity<3> with_unknowns(const GrainUnknowns<3>& u, double inverse_mass) {
  return {u[0], u[1], u[2], u[3], u[4], u[5], inverse_mass};
}

/// Inertia of unknown k over the mass: 1 for translations, that of the rim for the others.
template <int D>
constexpr double inertia_ratio(Index k) {
  return k < D ? 1 : 1 / rim_mass_ratio<D>;
}

/// |v|^2 without the rim, (m/s)^2.
inline double squared_velocity(const GrainVelocity<2>& v) { return v.x * v.x + v.y * v.y; }
inline double squared_velocity(const GrainVelocity<3>& v) { return v.x * v.x + v.y * v.y + v.z * v.z; }
inline double squared_rim(const GrainVelocity<2>& v) { return v.rim * v.rim; }
inline double squared_rim(const GrainVelocity<3>& v) {
  return v.rim_x * v.rim_x + v.rim_y * v.rim_y + v.rim_z * v.rim_z;
}

/// Speed of each body and that of its rim, added, m/s.
template <int D>
std::vector<double> speeds_of(std::span<const GrainVelocity<D>> v) {
  std::vector<double> speeds;
  speeds.reserve(v.size());
  for (const auto& one : v) speeds.push_back(std::sqrt(squared_velocity(one)) + std::sqrt(squared_rim(one)));
  return speeds;
}

/// Kinetic energy of a free grain, J.
template <int D>
double kinetic_energy(const GrainVelocity<D>& v) {
  return (squared_velocity(v) + squared_rim(v) / rim_mass_ratio<D>) / (2 * v.inverse_mass);
}

/// W of a contact of two grains: W_nn = 1/m_a + 1/m_b, W_tt = 3 W_nn for disks and 7/2 W_nn for spheres, W_nt = 0.
template <int D>
DiagonalDelassus grain_delassus(double inverse_mass_a, double inverse_mass_b) {
  const double inverse = 1 / (inverse_mass_a + inverse_mass_b);
  return {inverse, inverse * (1 / (1 + rim_mass_ratio<D>))};
}

/// W of a contact with levers: sum over both bodies of H_c^T M^-1 H_c.
template <int D>
FullDelassus<D> lever_delassus(const Levers<D>& levers, double inverse_mass_a, double inverse_mass_b) {
  std::array<std::array<double, D>, D> w{};
  const auto add = [&](const Lever<D>& lever, double inverse_mass) {
    for (std::size_t i = 0; i < D; ++i)
      for (std::size_t j = 0; j < D; ++j)
        for (std::size_t k = 0; k < lever.moves.size(); ++k)
          w[i][j] +=
              lever.moves[k] * inverse_mass * (k < D ? 1 : rim_mass_ratio<D>)*lever.rows[i][k] * lever.rows[j][k];
  };
  add(levers.a, inverse_mass_a);
  add(levers.b, inverse_mass_b);
  if (!levers.rubs())  // any regular block will do
    for (std::size_t d = 1; d < D; ++d) w[d][d] = w[0][0];
  if constexpr (D == 2)
    return {w[0][0], w[0][1], w[1][1]};
  else
    return {w[0][0], {w[0][1], w[0][2]}, {w[1][1], w[1][2], w[2][2]}};
}

/// One contact in its frame, n from a to b, with all data of a law. In the plane t is n turned by +90 degrees:
///     v_n = n (V_b - V_a),   v_t = t (V_b - V_a) - rim_a - rim_b,
/// in space (n, t_1, t_2) are those of tangents_of:
///     v_n = n (V_b - V_a),   v_t = t (V_b - V_a - (rim_a + rim_b) x n)  for t_1 and t_2.
/// A contact of bodies of another shape has `levers`. Sweeps use the shorter ContactRows.
template <int D>
struct GrainContact {
  std::int32_t a = 0, b = 0;                      ///< positions in the array of velocities
  Direction<D> normal{1, 0};                      ///< n
  double inverse_mass_a = 0, inverse_mass_b = 0;  ///< 1/kg
  LocalVector<D> bias = {};                       ///< m/s, added to v before the law: gap / h, restitution
  double friction = 0;
  double pull = 0;                               ///< largest pulling impulse, N s; 0 unless the law pulls
  LocalVector<D> impulse = {};                   ///< r, N s
  std::shared_ptr<const Levers<D>> levers = {};  ///< null for two grains

  /// W_c of two grains.
  DiagonalDelassus inverse_w() const { return grain_delassus<D>(inverse_mass_a, inverse_mass_b); }
};

/// use(W_c), whose type depends on the bodies: see DiagonalDelassus and FullDelassus.
template <int D, class Use>
decltype(auto) with_delassus(const GrainContact<D>& c, const Use& use) {
  if (c.levers == nullptr) return use(c.inverse_w());
  return use(lever_delassus(*c.levers, c.inverse_mass_a, c.inverse_mass_b));
}

/// 1/W_nn of a contact, kg.
template <int D>
double inverse_normal_delassus(const GrainContact<D>& c) {
  return with_delassus(c, [](const auto& w) { return w.inverse_normal(); });
}

/// Sums over the contacts of one sweep, (N s)^2: |r - r_before|^2 and |r|^2.
struct SweepSums {
  double change = 0, impulses = 0;
};

/// Relative velocity of a contact of two grains, m/s, without bias.
inline LocalVector<2> relative_velocity(const Direction<2>& normal, const GrainVelocity<2>& a,
                                        const GrainVelocity<2>& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  return {normal[0] * dx + normal[1] * dy, normal[0] * dy - normal[1] * dx - a.rim - b.rim};
}
inline LocalVector<3> relative_velocity(const Direction<3>& n, const GrainVelocity<3>& a, const GrainVelocity<3>& b) {
  const auto [t1, t2] = tangents_of(n);
  const double dx = b.x - a.x, dy = b.y - a.y, dz = b.z - a.z;
  const double sx = a.rim_x + b.rim_x, sy = a.rim_y + b.rim_y, sz = a.rim_z + b.rim_z;
  // t (s x n) = s (n x t), n x t_1 = t_2 and n x t_2 = -t_1
  return {n[0] * dx + n[1] * dy + n[2] * dz,
          {t1[0] * dx + t1[1] * dy + t1[2] * dz - (t2[0] * sx + t2[1] * sy + t2[2] * sz),
           t2[0] * dx + t2[1] * dy + t2[2] * dz + (t1[0] * sx + t1[1] * sy + t1[2] * sz)}};
}
/// The same; `levers`: null for two grains.
template <int D>
LocalVector<D> relative_velocity(const Direction<D>& normal, const Levers<D>* levers, const GrainVelocity<D>& a,
                                 const GrainVelocity<D>& b) {
  if (levers == nullptr) return relative_velocity(normal, a, b);
  return levers->a.velocity(unknowns(a)) + levers->b.velocity(unknowns(b));
}
template <int D>
LocalVector<D> relative_velocity(const GrainContact<D>& c, GrainVelocities<D> v) {
  return relative_velocity<D>(c.normal, c.levers.get(), v[at(c.a)], v[at(c.b)]);
}

/// Relative velocity of a contact by the driven unknowns of bodies with free directions.
template <int D>
LocalVector<D> driven_part(const GrainContact<D>& c, const std::vector<GrainVelocity<D>>& bodies) {
  LocalVector<D> sum;
  for (const auto& [lever, body] : {std::pair(&c.levers->a, c.a), std::pair(&c.levers->b, c.b)}) {
    const GrainVelocity<D>& v = bodies[at(body)];
    if (v.inverse_mass == 0) continue;  // counted whole
    GrainUnknowns<D> own = unknowns(v);
    for (std::size_t k = 0; k < own.size(); ++k) own[k] *= 1 - lever->moves[k];
    sum = sum + lever->velocity(own);
  }
  return sum;
}

/// V += M^-1 p of one grain, for an impulse p on its unknowns, N s.
template <int D>
void push(GrainVelocity<D>& grain, const std::type_identity_t<GrainUnknowns<D>>& p) {
  GrainUnknowns<D> v = unknowns(grain);
  for (std::size_t k = 0; k < v.size(); ++k) v[k] += (k < D ? 1 : rim_mass_ratio<D>)*grain.inverse_mass * p[k];
  grain = with_unknowns(v, grain.inverse_mass);
}

/// V += M^-1 H_c r: velocities of both bodies of a contact after impulses r on b, -r on a. `levers`: null for grains.
template <int D>
void apply_impulse(const Direction<D>& normal, const Levers<D>* levers, const LocalVector<D>& r, GrainVelocity<D>& a,
                   GrainVelocity<D>& b) {
  push(a, levers == nullptr ? impulse_on_grain(normal, -1, r) : levers->a.impulse(r));
  push(b, levers == nullptr ? impulse_on_grain(normal, 1, r) : levers->b.impulse(r));
}
template <int D>
void apply_impulse(const GrainContact<D>& c, LocalVector<D> r, std::type_identity_t<std::span<GrainVelocity<D>>> v) {
  apply_impulse<D>(c.normal, c.levers.get(), r, v[at(c.a)], v[at(c.b)]);
}

/// The impulse that would bring the contact to rest, bias included: r - W^-1 (v + bias).
template <int D>
LocalVector<D> stopping_impulse(const GrainContact<D>& c, GrainVelocities<D> v) {
  return with_delassus(c, [&](const auto& w) { return c.impulse - w.solve(relative_velocity(c, v) + c.bias); });
}

/// The impulse of the law where `stop` would bring the contact to rest; `w`: W_c.
template <int D, class Delassus>
LocalVector<D> law_impulse(const ContactLaw& law, const GrainContact<D>& c, LocalVector<D> stop, const Delassus& w) {
  return std::visit([&](const auto& one) { return law_at(one, c.pull).impulse(stop, w, c.friction); }, law);
}

/// A contact as a sweep reads it, 32 bytes in the plane and 40 in space.
template <int D>
struct ContactRow {
  std::int32_t a = 0, b = 0;  ///< positions in the array of velocities
  Direction<D> normal{1};
  double bias_n = 0;  ///< m/s
};

/// Contacts as a sweep reads them. Memory limits its speed, so constant data are apart and no mass or W is repeated.
template <int D>
struct ContactRows {
  std::vector<ContactRow<D>> rows;
  std::vector<SweptVector<D>> impulses;             ///< r, N s
  std::vector<decltype(SweptVector<D>::t)> bias_t;  ///< m/s; empty without tangential restitution
  std::vector<double> pull;                         ///< N s; empty unless the law pulls
  double friction = 0;                              ///< between free grains
  double boundary_friction = 0;                     ///< if one of both bodies is driven
  /// Levers of every contact, null for two grains, and friction; empty if no contact has levers or a friction of its
  /// own. The fast path of two grains does not read it.
  struct Other {
    std::shared_ptr<const Levers<D>> levers = {};
    double friction = 0;
  };
  std::vector<Other> others = {};

  std::size_t size() const { return rows.size(); }
  LocalVector<D> impulse(std::size_t k) const { return in_frame(rows[k].normal, impulses[k]); }
  void set_impulse(std::size_t k, const LocalVector<D>& r) { impulses[k] = swept(rows[k].normal, r); }
  GrainContact<D> contact(std::size_t k, std::span<const GrainVelocity<D>> v) const;
  const Levers<D>* levers(std::size_t k) const { return others.empty() ? nullptr : others[k].levers.get(); }
  /// Relative velocity of contact k, m/s, without bias; and V += M^-1 H_k r.
  LocalVector<D> relative_velocity_at(std::size_t k, std::span<const GrainVelocity<D>> v) const {
    return relative_velocity<D>(rows[k].normal, levers(k), v[at(rows[k].a)], v[at(rows[k].b)]);
  }
  void push_bodies(std::size_t k, const LocalVector<D>& r, std::span<GrainVelocity<D>> v) const {
    apply_impulse<D>(rows[k].normal, levers(k), r, v[at(rows[k].a)], v[at(rows[k].b)]);
  }
};

/// One nonlinear Gauss-Seidel sweep over the contacts in their order in memory, see take_impulse. Grains are updated at
/// once: W is never formed, and velocities carry its off-diagonal part.
template <int D>
SweepSums gauss_seidel_sweep(const ContactLaw& law, ContactRows<D>& contacts,
                             std::type_identity_t<std::span<GrainVelocity<D>>> v, double relaxation = 1);

}  // namespace nscdd
