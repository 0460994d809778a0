// SPDX-License-Identifier: GPL-3.0-or-later
// Solid fraction, rattlers and size classes of packings small enough to know by hand.
#include "packing/statistics.hpp"

#include "../support/problems.hpp"
#include "linalg/random.hpp"
#include "study/linear/inspection.hpp"
#include <nscdd/packing/generator.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace nscdd;
using std::numbers::pi;

TEST_CASE("statistics: the part of a disk in a corner, against known parts and counted points") {
  CHECK(disk_corner_area(0, 0) == doctest::Approx(pi / 4));
  CHECK(disk_corner_area(0, 1) == doctest::Approx(pi / 2));
  CHECK(disk_corner_area(2, 9) == doctest::Approx(pi));
  CHECK(disk_corner_area(-1, 3) == 0);
  CHECK(disk_corner_area(-0.8, -0.7) == 0);
  RandomStream random(1);
  for (const auto& [a, b] : {std::pair{0.3, 0.4}, {-0.3, 0.4}, {-0.3, -0.6}, {0.9, 0.8}, {-0.8, 0.9}, {0.9, -0.8}}) {
    constexpr int n = 200'000;
    int inside = 0;
    for (int i = 0; i < n; ++i) {
      const double x = 2 * random.uniform() - 1, y = 2 * random.uniform() - 1;
      if (x * x + y * y <= 1 && x <= a && y <= b) ++inside;
    }
    const double share = disk_corner_area(a, b) / 4;
    CHECK(std::abs(static_cast<double>(inside) / n - share) < 4 * std::sqrt(share * (1 - share) / n));
    CHECK(disk_corner_area(a, b) == doctest::Approx(disk_corner_area(b, a)));
  }
}

TEST_CASE("statistics: solid fractions known by hand") {
  const SolidFraction disk = solid_fraction({{3.0}, {-7.0}, {2.0}, {}});
  CHECK(disk.box == doctest::Approx(pi / 4));
  CHECK(disk.middle == doctest::Approx(1));  // the square of half the side lies in the disk
  // 2 x 2 disks on a square lattice: the middle square cuts a quarter out of each
  const SolidFraction square = solid_fraction({{0, 2, 0, 2}, {0, 0, 2, 2}, {1, 1, 1, 1}, {}});
  CHECK(square.box == doctest::Approx(pi / 4));
  CHECK(square.middle == doctest::Approx(pi / 4));
  // two disks side by side in a box 4 x 2, its middle 2 x 1: each gives 0 <= x <= 1, |y| <= 1/2
  const SolidFraction pair = solid_fraction({{0, 2}, {0, 0}, {1, 1}, {}});
  CHECK(pair.box == doctest::Approx(pi / 4));
  CHECK(pair.middle == doctest::Approx(std::sqrt(3) / 4 + pi / 6));
  // a large lattice comes near pi / (2 sqrt 3), and its middle nearer
  const double limit = pi / (2 * std::numbers::sqrt3);
  const SolidFraction lattice = solid_fraction(generate(HexagonalLattice{.columns = 200, .rows = 200}));
  CHECK(std::abs(lattice.middle - limit) < 0.002);
  CHECK(std::abs(lattice.middle - limit) < std::abs(lattice.box - limit));
}

TEST_CASE("statistics: the solid fraction of a periodic cell is that of the cell, wherever its grains are") {
  // A hexagonal lattice of radius 1: rows of two disks, turned by a radius; the cell has 4 x 2 sqrt 3.
  const double row = std::sqrt(3.0);
  const SolidFraction cell = solid_fraction({{1, 3, 0, 2}, {0, 0, row, row}, {1, 1, 1, 1}, {}}, {.x = 4, .y = 2 * row});
  CHECK(cell.box == doctest::Approx(pi / (2 * std::numbers::sqrt3)));
  const SolidFraction moved =
      solid_fraction({{-3, 3, 4, 10}, {0, 2 * row, row, -row}, {1, 1, 1, 1}, {}}, {.x = 4, .y = 2 * row});
  CHECK(moved.box == doctest::Approx(cell.box));
  CHECK(moved.middle == doctest::Approx(cell.middle));
  // Along y it ends: two spheres above each other in a cell 3 x 3, which is 4 high.
  CHECK(solid_fraction({{0, 0}, {0, 0}, {1, 1}, {}, {1, 3}}, {.x = 3, .y = 3}).box ==
        doctest::Approx(2 * 4 * pi / 3 / (3 * 3 * 4)));
}

TEST_CASE("statistics: the part of a sphere in a box, against octants, caps and counted points") {
  const auto cap = [](double h) { return pi * h * h * (3 - h) / 3; };  // of height h
  CHECK(sphere_box_volume({-1, -1, -1}, {1, 1, 1}) == doctest::Approx(4 * pi / 3).epsilon(1e-12));
  CHECK(sphere_box_volume({0, 0, 0}, {2, 2, 2}) == doctest::Approx(pi / 6).epsilon(1e-10));
  for (const double h : {0.1, 0.7, 1.0, 1.6})
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<double, 3> low{-3, -2, -5};
      low[k] = 1 - h;
      CHECK(std::abs(sphere_box_volume(low, {2, 3, 4}) - cap(h)) < 1e-9);
    }
  CHECK(sphere_box_volume({-0.2, -0.3, -0.1}, {0.3, 0.4, 0.2}) == doctest::Approx(0.5 * 0.7 * 0.3).epsilon(1e-10));
  CHECK(sphere_box_volume({0.8, 0.8, 0.8}, {2, 2, 2}) == doctest::Approx(0));
  CHECK(sphere_box_volume({1, -1, -1}, {2, 1, 1}) == 0);
  RandomStream random(3);
  for (int box = 0; box < 6; ++box) {
    std::array<double, 3> low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = 2.4 * random.uniform() - 1.2, b = 2.4 * random.uniform() - 1.2;
      low[k] = std::min(a, b);
      high[k] = std::max(a, b);
    }
    constexpr int n = 200'000;
    int inside = 0;
    for (int i = 0; i < n; ++i) {
      double square = 0;
      bool in_box = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = 2 * random.uniform() - 1;
        square += x * x;
        in_box = in_box && low[k] <= x && x <= high[k];
      }
      if (square <= 1 && in_box) ++inside;
    }
    const double share = sphere_box_volume(low, high) / 8;
    CHECK(std::abs(static_cast<double>(inside) / n - share) < 4 * std::sqrt(share * (1 - share) / n) + 1e-9);
  }
}

TEST_CASE("statistics: the parts of a sphere in eight boxes about a corner add up, wherever sides and corners cut") {
  RandomStream random(4);
  const auto number = [&] { return 2.6 * random.uniform() - 1.3; };
  double worst = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<double, 3> low{}, high{}, corner{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = number(), b = trial % 2 == 0 ? number() : 20;  // a box, or an octant of space
      low[k] = std::min(a, b);
      high[k] = std::max(a, b);
      corner[k] = std::clamp(number(), low[k], high[k]);
    }
    double sum = 0;
    for (std::size_t part = 0; part < 8; ++part) {
      std::array<double, 3> from = low, to = high;
      for (std::size_t k = 0; k < 3; ++k) ((part >> k & 1) == 0 ? to : from)[k] = corner[k];
      sum += sphere_box_volume(from, to);
    }
    worst = std::max(worst, std::abs(sum - sphere_box_volume(low, high)));
  }
  CHECK(worst < 1e-9);
}

TEST_CASE("statistics: spheres fill boxes, rest on three, and weigh by volume") {
  const SolidFraction one = solid_fraction({{3.0}, {-7.0}, {2.0}, {}, {5.0}});
  CHECK(one.box == doctest::Approx(pi / 6));
  CHECK(one.middle == doctest::Approx(1));  // the cube of half the side lies in the sphere
  // 2 x 2 x 2 spheres: the middle cube cuts an octant out of each
  const SolidFraction cube = solid_fraction(generate(CubicLattice{{.columns = 2, .rows = 2, .layers = 2}}));
  CHECK(cube.box == doctest::Approx(pi / 6));
  CHECK(cube.middle == doctest::Approx(pi / 6));
  // What is left to integrate is a few roundings wide.
  const SolidFraction small =
      solid_fraction(generate(CubicLattice{{.columns = 3, .rows = 5, .layers = 2, .radius = 0.001}}));
  CHECK(small.box == doctest::Approx(pi / 6));
  const double limit = pi / (3 * std::numbers::sqrt2);
  const SolidFraction lattice = solid_fraction(generate(FccLattice{{.columns = 30, .rows = 30, .layers = 42}}));
  CHECK(std::abs(lattice.middle - limit) < 0.01);
  CHECK(std::abs(lattice.middle - limit) < std::abs(lattice.box - limit));

  // a tetrahedron 0 1 2 3; 4 touches 2 and 3 alone, 5 touches 4
  const double s = std::sqrt(2.0);
  const Packing p{{0, s, s, 0, 0, 0}, {0, s, 0, s, 0, -s}, std::vector<double>(6, 1), {}, {0, 0, s, s, 2 * s, 3 * s}};
  const ContactNetwork network = detect_contacts(p);
  CHECK(contact_counts(network) == std::vector<Index>{3, 3, 4, 4, 3, 1});
  CHECK(rattlers(network) == std::vector<char>{0, 0, 0, 0, 1, 1});

  const auto classes = size_histogram({{0, 9, 19}, {0, 0, 0}, {1, 1, 2}, {}, {0, 0, 0}}, 2);
  CHECK(classes[0].measure == doctest::Approx(8 * pi / 3));
  CHECK(classes[1].measure == doctest::Approx(32 * pi / 3));
}

TEST_CASE("statistics: rattlers are what no closed loop of contacts holds") {
  // a triangle 0 1 2, a chain 3 4 hanging from it, 5 alone
  const Packing p{{0, 2, 1, 4, 6, 20}, {0, 0, std::numbers::sqrt3, 0, 0, 0}, {1, 1, 1, 1, 1, 1}, {}};
  CHECK(rattlers(detect_contacts(p)) == std::vector<char>{0, 0, 0, 1, 1, 1});
  CHECK(rattlers(detect_contacts({{0, 2, 4}, {0, 0, 0}, {1, 1, 1}, {}})) == std::vector<char>{1, 1, 1});
  CHECK(rattlers(detect_contacts(generate(TriangularStrip{.grains = 8}))) == std::vector<char>(8, 0));
  Case one;
  one.spec.packing = PackingFile{"triangle and chain"};
  one.packing = p;
  const Inspection found = inspect(build(one));
  CHECK(found.rattlers == 3);
  CHECK(found.coordination_number == doctest::Approx(10.0 / 6));
  CHECK(found.coordination_without_rattlers == doctest::Approx(2));
  one.spec.packing = PackingFile{"row"};
  one.packing = {{0, 2}, {0, 0}, {1, 1}, {}};
  CHECK(std::isnan(inspect(build(one)).coordination_without_rattlers));
}

TEST_CASE("statistics: size classes") {
  const Packing p{{0, 10, 20, 30}, {0, 0, 0, 0}, {1, 1.5, 2, 2}, {}};
  const auto classes = size_histogram(p, 4);
  REQUIRE(classes.size() == 4);
  CHECK(classes[0].from == 1);
  CHECK(classes[1].from == classes[0].to);
  CHECK(classes[3].to == 2);
  CHECK(classes[0].grains == 1);
  CHECK(classes[1].grains == 0);
  CHECK(classes[2].grains == 1);
  CHECK(classes[3].grains == 2);
  CHECK(classes[3].measure == doctest::Approx(8 * pi));
  const auto equal = size_histogram(generate(HexagonalLattice{}));
  REQUIRE(equal.size() == 1);
  CHECK(equal[0].grains == 64);
}

TEST_CASE("inspection: ranks are left out above the size asked for, counts are not") {
  const Model model = build(testing::strip(12));
  const Inspection with = inspect(model), without = inspect(model, 20);
  CHECK(with.ranks);
  CHECK_FALSE(without.ranks);
  CHECK((without.whole.grains == with.whole.grains && without.whole.contacts == with.whole.contacts));
  CHECK((without.whole.rank == 0 && without.interface_dofs == with.interface_dofs));
  CHECK(inspect(model, 21).ranks);
}
