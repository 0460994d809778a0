// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/random.hpp"
#include <nscdd/packing/generators/lattice.hpp>

#include <numbers>
#include <numeric>

namespace nscdd {
namespace {

// One number in [0, 1) per site.
std::vector<double> draw(RandomStream& random, Index sites) {
  std::vector<double> numbers(at(sites));
  for (double& number : numbers) number = random.uniform();
  return numbers;
}

// The sites of the smallest numbers, as flags: exactly as many as asked, and nested from fraction to fraction.
std::vector<char> vacant_sites(const std::vector<double>& numbers, double fraction) {
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

}  // namespace

Packing generate(const TriangularStrip& strip, const Monitor& monitor) {
  Packing packing;
  for (Index i = 0; i < strip.grains; ++i) {
    if (i % 4096 == 0 && !report(monitor, i, strip.grains)) break;
    packing.x.push_back(static_cast<double>(i) * strip.radius);
    packing.y.push_back(i % 2 == 0 ? 0.0 : std::numbers::sqrt3 * strip.radius);
    packing.radius.push_back(strip.radius);
  }
  return packing;
}

Packing generate(const HexagonalLattice& lattice, const Monitor& monitor) {
  const Index sites = lattice.columns * lattice.rows;
  if (sites > 10'000'000)
    fail("packing: expected at most 10000000 disks, met {} columns x {} rows", lattice.columns, lattice.rows);
  std::vector<double> shrinking;
  std::vector<char> vacant;
  if (lattice.vacancies > 0 || lattice.disorder > 0) {
    RandomStream random(static_cast<std::uint64_t>(lattice.seed));
    shrinking = draw(random, sites);
    vacant = vacant_sites(draw(random, sites), lattice.vacancies);
  }
  Packing packing;
  for (Index row = 0; row < lattice.rows; ++row) {
    if (!report(monitor, row * lattice.columns, sites)) break;
    for (Index column = 0; column < lattice.columns; ++column) {
      const std::size_t site = at(row * lattice.columns + column);
      if (!vacant.empty() && vacant[site] != 0) continue;
      packing.x.push_back(static_cast<double>(2 * column + row % 2) * lattice.radius);
      packing.y.push_back(static_cast<double>(row) * std::numbers::sqrt3 * lattice.radius);
      packing.radius.push_back(shrinking.empty() ? lattice.radius
                                                 : lattice.radius * (1 - lattice.disorder * shrinking[site]));
    }
  }
  return packing;
}

}  // namespace nscdd
