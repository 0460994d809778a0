// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/mechanics/disk_contacts.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace nscdd {

/// Contacts as a sweep reads them. At 10^5 grains a sweep is bound by memory: so what never changes lies
/// apart from the impulses, and what the velocities know already (masses, hence W) or the law (friction) is
/// not stored: 32 bytes read and 16 read and written per contact, where DiskContact has 88.
struct ContactRows {
  struct Row {
    std::int32_t a = 0, b = 0;  ///< positions in the array of velocities
    double normal_x = 1, normal_y = 0;
    double bias_n = 0;  ///< m/s
  };
  std::vector<Row> rows;
  std::vector<LocalVector> impulses;  ///< r, N s
  std::vector<double> bias_t;         ///< m/s; empty without tangential restitution
  std::vector<double> pull;           ///< N s; empty but for a law that pulls
  double friction = 0;                ///< between free disks
  double boundary_friction = 0;       ///< where one of both is driven

  std::size_t size() const { return rows.size(); }
  DiskContact contact(std::size_t k, std::span<const DiskVelocity> v) const;
};

/// One nonlinear Gauss-Seidel sweep, contacts in the order they lie in memory: each takes the impulse its law
/// gives at the present velocities (a part `relaxation` of the change), its disks are updated at once.
/// Velocities carry the off-diagonal part of W, which is never formed.
SweepSums gauss_seidel_sweep(const ContactLaw& law, ContactRows& contacts, std::span<DiskVelocity> v,
                             double relaxation = 1);

}  // namespace nscdd
