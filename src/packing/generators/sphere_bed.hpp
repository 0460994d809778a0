// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "packing/sphere_heap.hpp"
#include <nscdd/packing/generators/sphere_deposit.hpp>

namespace nscdd {

/// A deposit of spheres with the supports of each sphere, and the work of its generation.
struct SphereBed {
  Packing packing;
  double width = 0, depth = 0;  ///< m
  std::vector<SphereHeap::Supports> supports;
  RollingWork work;
};
SphereBed sphere_bed(const SphereDeposit& deposit, const Monitor& monitor = {});

}  // namespace nscdd
