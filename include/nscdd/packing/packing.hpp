// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>
#include <nscdd/core/types.hpp>

#include <optional>
#include <vector>

namespace nscdd {

/// Disks in the plane, grain i at (x[i], y[i]).
struct Packing {
  std::vector<double> x, y;    ///< centres, m
  std::vector<double> radius;  ///< m
  std::vector<double> mass;    ///< kg; empty until masses are chosen

  Index size() const { return count(x); }
};

/// Throws Error naming the grain where a coordinate is not finite or a radius (or mass, where given) is not
/// finite and positive, and for a packing without grains.
void check(const Packing& packing);

/// How grains get their mass.
enum class MassModel {
  given,    ///< the masses the packing came with
  unit,     ///< 1 kg each
  density,  ///< surface density x pi radius^2
};
constexpr auto names_of(MassModel) { return std::to_array<std::string_view>({"given", "unit", "density"}); }

struct Masses {
  /// Left open: the masses the packing came with, or unit masses where it came with none.
  std::optional<MassModel> model;
  double density = 0;  ///< kg/m^2, for MassModel::density
};

/// The packing with its masses set. Throws Error where `given` is asked of a packing without masses.
Packing with_masses(Packing packing, const Masses& masses);

}  // namespace nscdd
