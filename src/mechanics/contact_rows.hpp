// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/disk_contacts.hpp"
#include <nscdd/core/types.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace nscdd {

/// Contacts as a sweep reads them. At 10^5 grains memory limits the speed of a sweep. So what never changes
/// is stored apart from the impulses, and nothing is stored that the velocities (masses, hence W) or the law
/// (friction) know already. A sweep reads 32 bytes per contact and reads and writes 16; DiskContact has 88.
struct ContactRows {
  struct Row {
    std::int32_t a = 0, b = 0;  ///< positions in the array of velocities
    double normal_x = 1, normal_y = 0;
    double bias_n = 0;  ///< m/s
  };
  std::vector<Row> rows;
  std::vector<LocalVector> impulses;  ///< r, N s
  std::vector<double> bias_t;         ///< m/s; empty without tangential restitution
  std::vector<double> pull;           ///< N s; empty unless the law pulls
  double friction = 0;                ///< between free disks
  double boundary_friction = 0;       ///< if one of both bodies is driven

  std::size_t size() const { return rows.size(); }
  DiskContact contact(std::size_t k, std::span<const DiskVelocity> v) const;
};

/// One nonlinear Gauss-Seidel sweep over the contacts in the order they have in memory. Each takes the
/// impulse that its law gives at the present velocities, or the part `relaxation` of the way to it, and its
/// disks are updated at once. So the velocities carry the off-diagonal part of W, which is never formed.
SweepSums gauss_seidel_sweep(const ContactLaw& law, ContactRows& contacts, std::span<DiskVelocity> v,
                             double relaxation = 1);

}  // namespace nscdd
