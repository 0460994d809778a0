// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/packing/packing.hpp>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace nscdd {
namespace {

void require_positive(const std::vector<double>& values, const char* name) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) || values[i] <= 0)
      throw Error(fmt::format("grain {}: expected a finite {} > 0, met {}", i, name, values[i]));
}

}  // namespace

void check(const Packing& packing) {
  if (packing.size() == 0) throw Error("packing: expected at least one grain, met none");
  for (Index i = 0; i < packing.size(); ++i)
    if (!std::isfinite(packing.x[at(i)]) || !std::isfinite(packing.y[at(i)]))
      throw Error(
          fmt::format("grain {}: expected finite coordinates, met ({}, {})", i, packing.x[at(i)], packing.y[at(i)]));
  require_positive(packing.radius, "radius");
  require_positive(packing.mass, "mass");
}

Packing with_masses(Packing packing, const Masses& masses) {
  const MassModel model = masses.model.value_or(packing.mass.empty() ? MassModel::unit : MassModel::given);
  switch (model) {
    case MassModel::given:
      if (packing.mass.empty())
        throw Error("masses: expected a packing with masses (a 'mass' column) for model \"given\", met none");
      break;
    case MassModel::unit:
      packing.mass.assign(packing.radius.size(), 1.0);
      break;
    case MassModel::density:
      packing.mass.clear();
      for (const double r : packing.radius) packing.mass.push_back(masses.density * std::numbers::pi * r * r);
      break;
  }
  check(packing);
  return packing;
}

}  // namespace nscdd
