// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/random.hpp"
#include <nscdd/packing/generators/lattice.hpp>

#include <numbers>

namespace nscdd {
namespace {

using std::numbers::sqrt3;

constexpr Index most_sites = 10'000'000;

// Vacant sites, as flags: those of the smallest numbers, nested from fraction to fraction.
std::vector<char> vacant_sites(const std::vector<double>& numbers, double fraction) {
  const auto sites = static_cast<double>(numbers.size());
  const auto vacant = static_cast<std::ptrdiff_t>(std::min(std::round(fraction * sites), sites - 1));
  std::vector<Index> order = natural_order(count(numbers));
  std::ranges::nth_element(order, order.begin() + vacant, {}, [&](Index i) { return std::pair(numbers[at(i)], i); });
  std::vector<char> flags(numbers.size(), 0);
  std::for_each(order.begin(), order.begin() + vacant, [&](Index site) { flags[at(site)] = 1; });
  return flags;
}

// The grains of `rows` rows of sites, over all layers. centre_of(column, row): the centre of a site, in radii.
Packing occupied_sites(const auto& lattice, Index rows, const auto& centre_of, const Monitor& monitor) {
  const Index sites = lattice.columns * rows;
  std::vector<double> shrinking;
  std::vector<char> vacant;
  if (lattice.vacancies > 0 || lattice.disorder > 0) {
    RandomStream random(static_cast<std::uint64_t>(lattice.seed));
    shrinking = random.uniforms(sites);
    vacant = vacant_sites(random.uniforms(sites), lattice.vacancies);
  }
  Packing packing;
  for (Index row = 0; row < rows; ++row) {
    if (!report(monitor, row * lattice.columns, sites)) break;
    for (Index column = 0; column < lattice.columns; ++column) {
      const std::size_t site = at(row * lattice.columns + column);
      if (!vacant.empty() && vacant[site] != 0) continue;
      const std::array<double, 3> centre = centre_of(column, row);
      packing.x.push_back(centre[0] * lattice.radius);
      packing.y.push_back(centre[1] * lattice.radius);
      if constexpr (requires { lattice.layers; }) packing.z.push_back(centre[2] * lattice.radius);
      packing.radius.push_back(shrinking.empty() ? lattice.radius
                                                 : lattice.radius * (1 - lattice.disorder * shrinking[site]));
    }
  }
  return packing;
}

double real(Index whole) { return static_cast<double>(whole); }

std::array<double, 3> stacked_centre(Stacking stacking, Index column, Index row, Index layer) {
  const Index shift = layer % 2;
  if (stacking == Stacking::cubic) return {real(2 * column), real(2 * row), real(2 * layer)};
  if (stacking == Stacking::fcc)
    return {real(2 * column + shift), real(2 * row + shift), real(layer) * std::numbers::sqrt2};
  return {real(2 * column + row % 2 + shift), real(3 * row + shift) / sqrt3, real(layer) * std::sqrt(8.0 / 3)};
}

}  // namespace

Packing generate(const TriangularStrip& strip, const Monitor& monitor) {
  require_bounds(strip, "packing");
  Packing packing;
  for (Index i = 0; i < strip.grains; ++i) {
    if (i % 4096 == 0 && !report(monitor, i, strip.grains)) break;
    packing.x.push_back(real(i) * strip.radius);
    packing.y.push_back(i % 2 == 0 ? 0.0 : sqrt3 * strip.radius);
    packing.radius.push_back(strip.radius);
  }
  return packing;
}

Packing generate(const HexagonalLattice& lattice, const Monitor& monitor) {
  require_bounds(lattice, "packing");
  if (lattice.columns * lattice.rows > most_sites)
    fail("packing: expected at most {} disks, met {} columns x {} rows", most_sites, lattice.columns, lattice.rows);
  const auto centre = [](Index column, Index row) {
    return std::array{real(2 * column + row % 2), real(row) * sqrt3, 0.0};
  };
  return occupied_sites(lattice, lattice.rows, centre, monitor);
}

Packing generate(Stacking stacking, const SphereSites& sites, const Monitor& monitor) {
  require_bounds(sites, "packing");
  if (sites.columns * sites.rows > most_sites || sites.columns * sites.rows * sites.layers > most_sites)
    fail("packing: expected at most {} spheres, met {} columns x {} rows x {} layers", most_sites, sites.columns,
         sites.rows, sites.layers);
  const auto centre = [&](Index column, Index row) {
    return stacked_centre(stacking, column, row % sites.rows, row / sites.rows);
  };
  return occupied_sites(sites, sites.rows * sites.layers, centre, monitor);
}

}  // namespace nscdd
