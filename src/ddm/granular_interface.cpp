// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/granular_interface.hpp"

namespace nscdd {
namespace {

double component(const DiskVelocity& v, Index k) { return k == 0 ? v.x : k == 1 ? v.y : v.rim; }

const DiskVelocity& copy_of(const GranularDecomposition& parts, const GrainCopy& copy) {
  return parts.subdomains[at(copy.subdomain)].velocities[at(copy.grain)];
}

}  // namespace

Vector interface_jumps(const GranularDecomposition& parts) {
  return parts.interface.exchange(
      [&](Index e, Index grain, Index k) { return component(parts.subdomains[at(e)].velocities[at(grain)], k); });
}

double glued_speed_squared(const GranularDecomposition& parts) {
  double sum = 0;
  const auto add = [&](const GrainCopy& copy) {
    const DiskVelocity& v = copy_of(parts, copy);
    sum += v.x * v.x + v.y * v.y + v.rim * v.rim;
  };
  Index before = -1;
  for (const Gluing& row : parts.interface.gluing()) {
    if (row.grain != before) add(row.first);
    add(row.second);
    before = row.grain;
  }
  return sum;
}

Vector generic_interface_solve(const GranularDecomposition& parts, const Vector& g) {
  return parts.interface.solve_generic(
      [&](const GrainCopy& copy, Index k) {
        const double mass = 1 / copy_of(parts, copy).inverse_mass;
        return k < 2 ? mass : mass / rim_mass_ratio;
      },
      g);
}

void apply_interface_impulses(GranularDecomposition& parts, const Vector& change) {
  for (Index e = 0; e < count(parts.subdomains); ++e)
    for (const Tie& tie : parts.interface.ties(e)) {
      DiskVelocity& v = parts.subdomains[at(e)].velocities[at(tie.grain)];
      const auto impulse = [&](Index k) { return tie.sign * change[3 * tie.row + k]; };
      v.x -= v.inverse_mass * impulse(0);
      v.y -= v.inverse_mass * impulse(1);
      v.rim -= rim_mass_ratio * v.inverse_mass * impulse(2);
    }
}

}  // namespace nscdd
