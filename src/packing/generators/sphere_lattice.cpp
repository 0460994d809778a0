// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/generators/lattice_sites.hpp"
#include <nscdd/packing/generators/sphere_lattice.hpp>

#include <numbers>

namespace nscdd {
namespace {

// `centre(column, row, layer)` in radii.
template <class Centre>
Packing spheres_at(const SphereSites& sites, const Centre& centre, const Monitor& monitor) {
  if (sites.columns * sites.rows > most_sites || sites.columns * sites.rows * sites.layers > most_sites)
    fail("packing: expected at most {} spheres, met {} columns x {} rows x {} layers", most_sites, sites.columns,
         sites.rows, sites.layers);
  const auto add_centre = [&](Packing& packing, Index column, Index row) {
    const std::array<double, 3> place = centre(column, row % sites.rows, row / sites.rows);
    packing.x.push_back(place[0] * sites.radius);
    packing.y.push_back(place[1] * sites.radius);
    packing.z.push_back(place[2] * sites.radius);
  };
  return occupied_sites(sites, sites.rows * sites.layers, add_centre, monitor);
}

double real(Index whole) { return static_cast<double>(whole); }

}  // namespace

Packing generate(const CubicLattice& lattice, const Monitor& monitor) {
  const auto centre = [](Index column, Index row, Index layer) {
    return std::array{real(2 * column), real(2 * row), real(2 * layer)};
  };
  return spheres_at(lattice.sites, centre, monitor);
}

Packing generate(const FccLattice& lattice, const Monitor& monitor) {
  const auto centre = [](Index column, Index row, Index layer) {
    const Index shift = layer % 2;
    return std::array{real(2 * column + shift), real(2 * row + shift), real(layer) * std::numbers::sqrt2};
  };
  return spheres_at(lattice.sites, centre, monitor);
}

Packing generate(const HcpLattice& lattice, const Monitor& monitor) {
  const auto centre = [](Index column, Index row, Index layer) {
    const Index shift = layer % 2;
    return std::array{real(2 * column + row % 2 + shift), real(3 * row + shift) / std::numbers::sqrt3,
                      real(layer) * std::sqrt(8.0 / 3)};
  };
  return spheres_at(lattice.sites, centre, monitor);
}

}  // namespace nscdd
