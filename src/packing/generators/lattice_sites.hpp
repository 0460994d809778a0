// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include "linalg/random.hpp"
#include <nscdd/packing/packing.hpp>

#include <numeric>

namespace nscdd {

inline constexpr Index most_sites = 10'000'000;

/// One number in [0, 1) per site.
inline std::vector<double> draw(RandomStream& random, Index sites) {
  std::vector<double> numbers(at(sites));
  for (double& number : numbers) number = random.uniform();
  return numbers;
}

/// Vacant sites, as flags: those of the smallest numbers, nested from fraction to fraction.
inline std::vector<char> vacant_sites(const std::vector<double>& numbers, double fraction) {
  const auto sites = static_cast<double>(numbers.size());
  const auto vacant = static_cast<std::ptrdiff_t>(std::min(std::round(fraction * sites), sites - 1));
  std::vector<std::size_t> order(numbers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::nth_element(order.begin(), order.begin() + vacant, order.end(),
                   [&](std::size_t i, std::size_t j) { return std::pair(numbers[i], i) < std::pair(numbers[j], j); });
  std::vector<char> flags(numbers.size(), 0);
  std::for_each(order.begin(), order.begin() + vacant, [&](std::size_t site) { flags[site] = 1; });
  return flags;
}

/// The grains of `rows` rows of sites, in any number of layers, without vacant sites, with shrunk radii.
/// `add_centre(packing, column, row)` puts the centre of a site there.
template <class Sites, class AddCentre>
Packing occupied_sites(const Sites& lattice, Index rows, const AddCentre& add_centre, const Monitor& monitor) {
  const Index sites = lattice.columns * rows;
  std::vector<double> shrinking;
  std::vector<char> vacant;
  if (lattice.vacancies > 0 || lattice.disorder > 0) {
    RandomStream random(static_cast<std::uint64_t>(lattice.seed));
    shrinking = draw(random, sites);
    vacant = vacant_sites(draw(random, sites), lattice.vacancies);
  }
  Packing packing;
  for (Index row = 0; row < rows; ++row) {
    if (!report(monitor, row * lattice.columns, sites)) break;
    for (Index column = 0; column < lattice.columns; ++column) {
      const std::size_t site = at(row * lattice.columns + column);
      if (!vacant.empty() && vacant[site] != 0) continue;
      add_centre(packing, column, row);
      packing.radius.push_back(shrinking.empty() ? lattice.radius
                                                 : lattice.radius * (1 - lattice.disorder * shrinking[site]));
    }
  }
  return packing;
}

}  // namespace nscdd
