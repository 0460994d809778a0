// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/contact_frame.hpp"
#include "mechanics/contact_law.hpp"

namespace nscdd {

/// Velocity of a disk while a step is solved. The speed of the rim, radius x angular velocity, stands for the spin: a
/// full disk has the inertia mass/2 in it, whatever its radius, and contacts need no lever arm.
struct DiskVelocity {
  double x = 0, y = 0, rim = 0;  ///< m/s
  double inverse_mass = 0;       ///< 1/kg; 0 for a body whose motion is prescribed
};

/// Mass over inertia in the speed of the rim: I / R^2 = mass / 2 of a full disk.
inline constexpr double rim_mass_ratio = 2.0;

/// W of a contact of two disks: W_nn = 1/m_a + 1/m_b, W_tt = 3 W_nn (rim mass 1/2), W_nt = 0.
inline DiagonalDelassus disk_delassus(const DiskVelocity& a, const DiskVelocity& b) {
  const double inverse = 1 / (a.inverse_mass + b.inverse_mass);
  return {inverse, inverse * (1 / (1 + rim_mass_ratio))};
}

/// One contact of a <- b in the frame (n, t), n from a to b, t = n turned by +90 degrees:
///     v_n = n (V_b - V_a),   v_t = t (V_b - V_a) - rim_a - rim_b,
/// with everything a law may need. Sweeps use the shorter ContactRows.
struct DiskContact {
  std::int32_t a = 0, b = 0;           ///< positions in the array of velocities
  std::array<double, 2> normal{1, 0};  ///< n
  DiagonalDelassus inverse_w;          ///< kg
  LocalVector<2> bias = {};            ///< m/s, added to v before the law: gap / h, restitution
  double friction = 0;
  double pull = 0;              ///< largest pulling impulse, N s; 0 unless the law pulls
  LocalVector<2> impulse = {};  ///< r, N s
};

/// Sums over the contacts of one sweep, (N s)^2: |r - r_before|^2 and |r|^2.
struct SweepSums {
  double change = 0, impulses = 0;
};

/// Relative velocity of a contact, m/s, without bias.
inline LocalVector<2> relative_velocity(const DiskContact& c, std::span<const DiskVelocity> v) {
  const DiskVelocity& a = v[static_cast<std::size_t>(c.a)];
  const DiskVelocity& b = v[static_cast<std::size_t>(c.b)];
  const double dx = b.x - a.x, dy = b.y - a.y;
  return {c.normal[0] * dx + c.normal[1] * dy, c.normal[0] * dy - c.normal[1] * dx - a.rim - b.rim};
}

/// V += M^-1 p of one disk, for an impulse p = (x, y, rim) on it, N s.
inline void push(DiskVelocity& disk, const std::array<double, 3>& p) {
  disk.x += disk.inverse_mass * p[0];
  disk.y += disk.inverse_mass * p[1];
  disk.rim += rim_mass_ratio * disk.inverse_mass * p[2];
}

/// V += M^-1 H_c r: the velocities of both disks of a contact after an impulse r on b and -r on a.
inline void apply_impulse(const DiskContact& c, LocalVector<2> r, std::span<DiskVelocity> v) {
  push(v[static_cast<std::size_t>(c.a)], impulse_on_grain(c.normal, -1, r));
  push(v[static_cast<std::size_t>(c.b)], impulse_on_grain(c.normal, 1, r));
}

/// The impulse with which the contact would be at rest, bias included: r - W^-1 (v + bias).
inline LocalVector<2> stopping_impulse(const DiskContact& c, std::span<const DiskVelocity> v) {
  return c.impulse - c.inverse_w.solve(relative_velocity(c, v) + c.bias);
}

/// Contacts as a sweep reads them. At 10^5 grains memory limits its speed: what never changes is stored apart from the
/// impulses, and nothing that the velocities (masses, hence W) or the law (friction) know already. A sweep reads 32
/// bytes per contact and reads and writes 16; DiskContact has 88.
struct ContactRows {
  struct Row {
    std::int32_t a = 0, b = 0;  ///< positions in the array of velocities
    double normal_x = 1, normal_y = 0;
    double bias_n = 0;  ///< m/s
  };
  std::vector<Row> rows;
  std::vector<LocalVector<2>> impulses;  ///< r, N s
  std::vector<double> bias_t;            ///< m/s; empty without tangential restitution
  std::vector<double> pull;              ///< N s; empty unless the law pulls
  double friction = 0;                   ///< between free disks
  double boundary_friction = 0;          ///< if one of both bodies is driven

  std::size_t size() const { return rows.size(); }
  DiskContact contact(std::size_t k, std::span<const DiskVelocity> v) const;
};

/// One nonlinear Gauss-Seidel sweep over the contacts in the order they have in memory. Each takes the impulse that its
/// law gives at the present velocities, or the part `relaxation` of the way to it, and its disks are updated at once:
/// the velocities carry the off-diagonal part of W, which is never formed.
SweepSums gauss_seidel_sweep(const ContactLaw& law, ContactRows& contacts, std::span<DiskVelocity> v,
                             double relaxation = 1);

/// How well impulses and velocities obey the contact law: sums over contacts, so that subdomains add up.
struct ContactResidual {
  double natural_map = 0;     ///< |natural map|^2 with rho = 1/W_nn of each contact, (N s)^2
  double impulses = 0;        ///< |r|^2, (N s)^2
  double violation = 0;       ///< |W_c (r_c' - r_c)|^2, r_c' the law's answer now; SumDVDV of LMGC90, (m/s)^2
  double work = 0;            ///< (r_c' + r_c)/2 . W_c (r_c' - r_c); SumDVoR of LMGC90, J
  double scale_work = 0;      ///< mean of r_c . W_c r_c and r_c' . W_c r_c'; SumWRR of LMGC90, J
  double scale_velocity = 0;  ///< mean of |W_c r_c|^2 and |W_c r_c'|^2; SumWRWR of LMGC90, (m/s)^2
  Index active = 0;           ///< contacts with an impulse
  Index stick = 0, slide = 0;

  ContactResidual& operator+=(const ContactResidual& other);

  /// |natural map| / |r|: error of the contact law in the form of De Saxce; 0 if there is no impulse.
  double relative_natural_map() const;
  /// LMGC90's criteria "Quad /DV" and "mean DV over r", not yet divided by its tolerance.
  double quad_dv() const;
  double mean_dv_over_r() const;
};

/// Sums over the contacts at the velocities v. With a cohesive law the natural map is that of the shifted impulses,
/// with a viscous law r' - r.
ContactResidual contact_residual(const ContactLaw& law, const ContactRows& contacts, std::span<const DiskVelocity> v);
ContactResidual contact_residual(const ContactLaw& law, std::span<const DiskContact> contacts,
                                 std::span<const DiskVelocity> v);

/// Status of each contact under the law: open, stick or slide.
ContactStatus status_of(const ContactLaw& law, const DiskContact& contact);

}  // namespace nscdd
