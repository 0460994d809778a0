// SPDX-License-Identifier: GPL-3.0-or-later
#include "../support/small_packings.hpp"
#include "linalg/random.hpp"
#include "packing/grain_grid.hpp"
#include <nscdd/packing/generator.hpp>
#include <nscdd/packing/packing.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <utility>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("contacts: the cell grid finds what brute force finds, sizes 1 : 50, clustered and scattered") {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    RandomStream random(seed);
    Packing packing;
    const double spread = seed == 4 ? 1e6 : 6.0;
    for (int i = 0; i < 250; ++i) {
      packing.x.push_back(spread * random.uniform());
      packing.y.push_back((seed == 3 ? 0.0 : spread) * random.uniform());
      packing.radius.push_back(0.02 * std::pow(50.0, random.uniform()));
    }
    const ContactDetection loose{.tolerance = 0.3, .overlap_tolerance = 1.0};
    Packing apart = packing;  // overlaps of any depth are too deep to accept: thin the packing out
    Packing kept;
    for (Index i = 0; i < apart.size(); ++i) {
      bool clear = true;
      for (Index j = 0; j < kept.size(); ++j)
        clear = clear && std::hypot(apart.x[at(i)] - kept.x[at(j)], apart.y[at(i)] - kept.y[at(j)]) >=
                             std::max(apart.radius[at(i)], kept.radius[at(j)]);
      if (!clear) continue;
      kept.x.push_back(apart.x[at(i)]);
      kept.y.push_back(apart.y[at(i)]);
      kept.radius.push_back(apart.radius[at(i)]);
    }
    const auto expected = touching_pairs(kept, loose.tolerance);
    const ContactNetwork found = detect_contacts(kept, loose);
    if (seed < 4) CHECK(expected.size() > 10);
    CHECK(pairs_of(found) == expected);
    CHECK(found.contacts.size() == expected.size());
  }
}

TEST_CASE("contacts: sizes 1 : 100, by number and by volume, as brute force finds them, in order") {
  for (const std::string distribution : {"two_sizes", "uniform_volume", "lognormal"}) {
    CAPTURE(distribution);
    const SizeDistribution sizes{.distribution = distribution,
                                 .radius_min = 0.01,
                                 .radius_max = 1,
                                 .fraction_large = 0.01,
                                 .median = 0.05,
                                 .sigma = 1.5};
    const Packing packing = generate(Deposit{.grains = 1500, .sizes = sizes, .seed = 3});
    for (const double tolerance : {1e-7, 0.5}) {
      const auto expected = touching_pairs(packing, tolerance);
      const ContactNetwork found = detect_contacts(packing, {.tolerance = tolerance, .overlap_tolerance = 1e-6});
      REQUIRE(found.contacts.size() == expected.size());
      auto pair = expected.begin();  // ascending
      for (const Contact& contact : found.contacts) CHECK(std::pair(contact.a, contact.b) == *pair++);
    }
  }
}

TEST_CASE("disk grid: every pair within reach once, and few others, whatever the sizes") {
  struct Sizes {
    double ratio, large;  // large: fraction of disks of the largest size, the others of all sizes if 0
    Index most;           // pairs visited per disk: one grid would visit 1900 at 1 : 100, two sizes
  };
  for (const Sizes& sizes : {Sizes{1, 1, 60}, {1.9, 0, 60}, {100, 0, 120}, {100, 0.002, 60}, {1e9, 0, 120}}) {
    const double ratio = sizes.ratio, large = sizes.large;
    CAPTURE(ratio);
    RandomStream random(11);
    std::vector<double> x, y, reach;
    double area = 0;
    for (int i = 0; i < 2000; ++i) {
      const double u = random.uniform();
      reach.push_back(large > 0 ? (u < large ? 1.0 : 1 / ratio) : std::pow(ratio, -u));
      area += reach.back() * reach.back();
    }
    for (std::size_t i = 0; i < reach.size(); ++i) {
      x.push_back(2 * std::sqrt(area) * random.uniform() - 3);
      y.push_back(2 * std::sqrt(area) * random.uniform() + 7);
    }
    std::vector<std::pair<Index, Index>> visited;
    // A range of its own, beside the radii, as the motion of disks in a step asks for.
    const double range = 0.5 / ratio;
    GrainGrid({x, y, {}}, reach, 1, range).for_each_pair([&](Index i, Index j) { visited.emplace_back(i, j); });
    CHECK(count(visited) < sizes.most * count(reach));
    const std::set<std::pair<Index, Index>> once(visited.begin(), visited.end());
    CHECK(once.size() == visited.size());
    Index missed = 0, near = 0;
    for (Index i = 0; i < count(reach); ++i)
      for (Index j = i + 1; j < count(reach); ++j)
        if (std::hypot(x[at(i)] - x[at(j)], y[at(i)] - y[at(j)]) <= reach[at(i)] + reach[at(j)] + range) {
          ++near;
          missed += !once.contains({i, j});
        }
    CHECK(near > 500);
    CHECK(missed == 0);
  }
  GrainGrid({}, {}).for_each_pair([](Index, Index) { FAIL("a pair of no disks"); });
}

TEST_CASE("contacts: normals, midpoints of centres, gaps, order") {
  Packing packing{{0.0, 3.0, 0.0}, {0.0, 0.0, -4.0}, {1.0, 2.0, 3.0}, {}};
  const ContactNetwork network = detect_contacts(packing);
  REQUIRE(network.size() == 3);
  CHECK((network.contacts[0].a == 0 && network.contacts[0].b == 1));
  CHECK(network.contacts[0].normal == std::array<double, 3>{1.0, 0.0, 0.0});
  CHECK(network.contacts[0].midpoint == std::array<double, 3>{1.5, 0.0, 0.0});  // of the centres, not of the contact
  CHECK(network.contacts[1].normal == std::array<double, 3>{0.0, -1.0, 0.0});
  CHECK(network.contacts[2].normal[0] == doctest::Approx(-0.6));
  CHECK(network.contacts[2].gap == doctest::Approx(0.0));
  CHECK(contact_counts(network) == std::vector<Index>{2, 2, 2});
}

TEST_CASE("contacts: the tolerance decides, on either side") {
  const double radius = 0.5;
  for (const auto& [gap, touching] : {std::pair{0.9e-7 * radius, true}, {1.1e-7 * radius, false}}) {
    const Packing packing{{0.0, 1.0 + gap}, {0.0, 0.0}, {radius, radius}, {}};
    CHECK((detect_contacts(packing).size() == 1) == touching);
  }
}

TEST_CASE("contacts: overlapping and coincident grains are named") {
  CHECK_THROWS_WITH_AS(detect_contacts({{0.0, 5.0, 0.9}, {0.0, 0.0, 0.0}, {0.5, 0.5, 0.5}, {}}),
                       doctest::Contains("grains 0 and 2 overlap by"), Error);
  CHECK_THROWS_WITH_AS(detect_contacts({{0.0, 2.0, 0.0}, {0.0, 0.0, 0.0}, {0.5, 0.5, 0.5}, {}}),
                       doctest::Contains("grains 0 and 2 have the same centre"), Error);
  const Packing slightly{{0.0, 0.99}, {0.0, 0.0}, {0.5, 0.5}, {}};
  CHECK_THROWS_AS(detect_contacts(slightly), Error);
  CHECK(detect_contacts(slightly, {.tolerance = 1e-7, .overlap_tolerance = 0.05}).size() == 1);
  CHECK(detect_contacts(slightly, {.tolerance = 1e-7, .overlap_tolerance = 0.021}).size() == 1);
  CHECK_THROWS_AS(detect_contacts(slightly, {.tolerance = 1e-7, .overlap_tolerance = 0.019}), Error);
}

TEST_CASE("packings: values that are no grains are refused") {
  CHECK_THROWS_AS(check(Packing{}), Error);
  for (const double bad : {0.0, -1.0, not_a_number, infinity}) {
    CHECK_THROWS_WITH_AS(check({{0.0, 1.0}, {0.0, 0.0}, {1.0, bad}, {}}), doctest::Contains("grain 1"), Error);
    CHECK_THROWS_AS(check({{0.0}, {0.0}, {1.0}, {bad}}), Error);
  }
  CHECK_THROWS_AS(check({{infinity}, {0.0}, {1.0}, {}}), Error);
  CHECK_THROWS_WITH_AS(check({{0.0, 1.0}, {0.0}, {1.0, 1.0}, {}}), doctest::Contains("a y for each of 2"), Error);
  CHECK_THROWS_WITH_AS(check({{0.0, 1.0}, {0.0, 0.0}, {1.0}, {}}), doctest::Contains("a radius for each"), Error);
  CHECK_THROWS_WITH_AS(check({{0.0, 1.0}, {0.0, 0.0}, {1.0, 1.0}, {1.0}}), doctest::Contains("a mass for"), Error);
}

TEST_CASE("masses: given, unit, density, and the default") {
  const Packing bare{{0.0}, {0.0}, {2.0}, {}}, weighed{{0.0}, {0.0}, {2.0}, {7.0}};
  CHECK(with_masses(bare, {}).mass[0] == 1.0);
  CHECK(with_masses(weighed, {}).mass[0] == 7.0);
  CHECK(with_masses(weighed, {MassModel::unit, 0}).mass[0] == 1.0);
  CHECK(with_masses(weighed, {MassModel::density, 3.0}).mass[0] == doctest::Approx(12 * std::numbers::pi));
  CHECK_THROWS_AS(with_masses(bare, {MassModel::given, 0}), Error);
}

TEST_CASE("generators: strips are isostatic, lattices have the contacts of a triangulation") {
  for (const Index n : {2, 3, 4, 8, 12, 57}) {
    const Packing packing = generate(TriangularStrip{.grains = n, .radius = 0.3});
    CHECK(packing.size() == n);
    CHECK(detect_contacts(packing).size() == 2 * n - 3);
  }
  const Packing lattice = generate(HexagonalLattice{.columns = 5, .rows = 4, .radius = 2.0});
  CHECK(lattice.size() == 20);
  CHECK(detect_contacts(lattice).size() == 4 * 4 + 3 * (2 * 5 - 1));
  CHECK(generate(TriangularStrip{.grains = 1}).size() == 1);
  CHECK_THROWS_AS(generate(HexagonalLattice{.columns = 100000, .rows = 1000}), Error);
}
