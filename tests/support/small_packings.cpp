// SPDX-License-Identifier: GPL-3.0-or-later
#include "small_packings.hpp"

#include "linalg/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace nscdd::testing {
namespace {

Index one_of(RandomStream& random, Index count) {
  return std::min(count - 1, static_cast<Index>(random.uniform() * static_cast<double>(count)));
}

void add(Packing& packing, double x, double y, double radius) {
  packing.x.push_back(x);
  packing.y.push_back(y);
  packing.radius.push_back(radius);
}

// Rows of disks of radius 1/2 right above each other, or shifted by half a disk; sites stay empty with a probability.
Packing lattice(RandomStream& random, bool hexagonal) {
  const Index columns = 2 + one_of(random, 7), rows = 1 + one_of(random, hexagonal ? 8 : 20);
  const double holes = random.uniform() < 0.5 ? 0 : 0.3 * random.uniform();
  Packing packing;
  for (Index j = 0; j < rows; ++j)
    for (Index i = 0; i < columns; ++i) {
      if (random.uniform() < holes) continue;
      const auto x = static_cast<double>(i), y = static_cast<double>(j);
      add(packing, hexagonal ? x + 0.5 * static_cast<double>(j % 2) : x, hexagonal ? y * std::sqrt(0.75) : y, 0.5);
    }
  return packing;
}

// Disks in a line, some of them of half the size.
Packing chain(RandomStream& random) {
  const Index grains = 2 + one_of(random, 30);
  const bool two_sizes = random.uniform() < 0.5;
  Packing packing;
  double x = 0;
  for (Index i = 0; i < grains; ++i) {
    const double radius = two_sizes && random.uniform() < 0.5 ? 0.25 : 0.5;
    x += radius;
    add(packing, x, 0, radius);
    x += radius;
  }
  return packing;
}

Packing ring(RandomStream& random) {
  const Index grains = 3 + one_of(random, 30);
  const double step = 2 * std::numbers::pi / static_cast<double>(grains), circle = 0.5 / std::sin(step / 2);
  Packing packing;
  for (Index i = 0; i < grains; ++i)
    add(packing, circle * std::cos(step * static_cast<double>(i)), circle * std::sin(step * static_cast<double>(i)),
        0.5);
  return packing;
}

Packing cubic(RandomStream& random) {
  const Index nx = 2 + one_of(random, 4), ny = 1 + one_of(random, 4), nz = 1 + one_of(random, 4);
  const double holes = random.uniform() < 0.5 ? 0 : 0.3 * random.uniform();
  Packing packing;
  for (Index k = 0; k < nz; ++k)
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        if (random.uniform() < holes) continue;
        add(packing, static_cast<double>(i), static_cast<double>(j), 0.5);
        packing.z.push_back(static_cast<double>(k));
      }
  return packing;
}

Packing shape(RandomStream& random) {
  switch (one_of(random, 4)) {
    case 0:
      return lattice(random, false);
    case 1:
      return lattice(random, true);
    case 2:
      return chain(random);
    default:
      return ring(random);
  }
}

double top(const Packing& packing) { return packing.y.empty() ? 0 : *std::ranges::max_element(packing.y); }
double bottom(const Packing& packing) { return packing.y.empty() ? 0 : *std::ranges::min_element(packing.y); }

// `other` above `packing`, two disks apart.
void stack(Packing& packing, const Packing& other) {
  const double shift = packing.size() == 0 ? 0 : std::ceil(top(packing) - bottom(other)) + 2;
  for (std::size_t i = 0; i < other.x.size(); ++i) add(packing, other.x[i], other.y[i] + shift, other.radius[i]);
}

}  // namespace

SmallProblem small_problem(std::uint64_t seed) {
  RandomStream random(seed);
  SmallProblem small;
  Packing packing;
  const Index kind = one_of(random, 4);
  static const char* const names[] = {"one", "copies", "several", "cubic"};
  small.one.spec.name = names[kind];
  if (kind == 3) {
    packing = cubic(random);
  } else {
    packing = shape(random);
    const Packing first = packing;
    for (Index more = kind == 0 ? 0 : 1 + one_of(random, 4); more > 0; --more)
      stack(packing, kind == 1 ? first : shape(random));
  }
  if (packing.size() == 0) {
    add(packing, 0, 0, 0.5);
    if (kind == 3) packing.z.push_back(0);
  }
  if (random.uniform() < 0.3)
    for (Index i = 0; i < packing.size(); ++i) packing.mass.push_back(random.uniform() < 0.5 ? 1.0 : 4.0);
  const auto number = [&](Index most) { return 1 + one_of(random, most); };
  if (random.uniform() < 0.25)
    small.one.spec.partition = MetisPartitioner{.metis = std::min<Index>(2 + one_of(random, 5), 3), .seed = 1};
  else if (kind == 3)
    small.one.spec.partition = GridPartitioner{{number(3), number(3), number(2)}};
  else
    small.one.spec.partition = GridPartitioner{{1 + number(3), number(3)}};
  small.one.spec.packing = PackingFile{"made in a test"};
  small.one.packing = packing;
  static constexpr double epsilons[] = {0, 1e-6, 1e-3, 1, 1, 1e3, 1e7},
                          etas[] = {infinity, infinity, 1e-2, 1, 1e3, 1e-4, 1e6};
  small.epsilon = epsilons[one_of(random, 7)];
  small.eta = etas[one_of(random, 7)];
  small.eigenvalues = random.uniform() < 0.5 ? 1 : 1 + one_of(random, 8);
  return small;
}

Pairs pairs_of(const ContactNetwork& network) {
  Pairs pairs;
  for (const Contact& contact : network.contacts) pairs.insert({contact.a, contact.b});
  return pairs;
}

Pairs touching_pairs(const Packing& packing, double tolerance) {
  const auto& [x, y, z, radius] = std::tie(packing.x, packing.y, packing.z, packing.radius);
  Pairs pairs;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = i + 1; j < x.size(); ++j) {
      const double dx = x[i] - x[j], dy = y[i] - y[j];
      const double distance = z.empty() ? std::hypot(dx, dy) : std::hypot(dx, dy, z[i] - z[j]);
      const double gap = distance - radius[i] - radius[j];
      if (gap <= tolerance * std::min(radius[i], radius[j]))
        pairs.insert({static_cast<Index>(i), static_cast<Index>(j)});
    }
  return pairs;
}

}  // namespace nscdd::testing
