// SPDX-License-Identifier: GPL-3.0-or-later
// Generators of packings: exact tangencies, sizes as they should be distributed, equal seeds equal bytes.
#include "../support/sanitized.hpp"
#include "../support/small_packings.hpp"
#include "linalg/random.hpp"
#include "packing/drop_and_roll.hpp"
#include "packing/statistics.hpp"
#include <nscdd/packing/generator.hpp>
#include <nscdd/packing/packing.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Where a grain is held: horizontal places of what touches it, and whether the floor does.
struct Support {
  bool floor = false, left = false, right = false;
};

// Every grain that its predecessors, walls and floor hold, by the contacts of the packing alone.
std::vector<Support> supports(const Packing& p, const ContactNetwork& network, double width) {
  std::vector<Support> all(at(p.size()));
  for (const Contact& contact : network.contacts) {
    // grains are numbered as they fell: the later one rests on the earlier
    const double from_centre = -contact.normal[0];
    if (from_centre <= 0) all[at(contact.b)].left = true;
    if (from_centre >= 0) all[at(contact.b)].right = true;
  }
  for (Index i = 0; i < p.size(); ++i) {
    const double r = p.radius[at(i)];
    all[at(i)].floor = p.y[at(i)] == r;
    all[at(i)].left = all[at(i)].left || p.x[at(i)] == r;
    all[at(i)].right = all[at(i)].right || p.x[at(i)] == width - r;
  }
  return all;
}

// Checks a deposit in a box of that width: nothing overlaps or leaves the box, everything is held.
void check_deposit(const Deposit& deposit, double width) {
  const Packing p = generate(deposit);
  REQUIRE(p.size() == deposit.grains);
  check(p);
  const ContactNetwork network = detect_contacts(p, {.tolerance = 1e-9, .overlap_tolerance = 1e-7});
  double scale = 0, deepest = 0;
  for (Index i = 0; i < p.size(); ++i) {
    const double r = p.radius[at(i)];
    if (p.y[at(i)] < r || p.x[at(i)] < r || p.x[at(i)] > width - r) FAIL("grain ", i, " is not in the box");
    scale = std::max({scale, p.x[at(i)], p.y[at(i)]});
  }
  for (const Contact& contact : network.contacts) deepest = std::min(deepest, contact.gap);
  CHECK(deepest >= -1e-15 * scale);  // a few roundings of coordinates
  const std::vector<Support> held = supports(p, network, width);
  for (Index i = 0; i < p.size(); ++i)
    if (!held[at(i)].floor && !(held[at(i)].left && held[at(i)].right)) FAIL("grain ", i, " is not held");
}

// Drop and roll as the papers say it: every grain of the bed is tried. Of grains that are met at one place
// the first one tried counts: by rows of square cells, downwards for a fall and upwards for rolling, in a row
// from left to right, in a cell from the latest grain to the first.
struct LiteralHeap {
  double width, cell;
  std::vector<Disk> down = {}, up = {};

  void add(const Disk& disk) {
    const auto insert = [&](std::vector<Disk>& order, double sign) {
      const auto place = [&](const Disk& d) {
        return std::pair(sign * std::floor(d.y / cell), std::floor(d.x / cell));
      };
      const auto before = [&](const Disk& a, const Disk& b) { return place(a) < place(b); };
      order.insert(std::lower_bound(order.begin(), order.end(), disk, before), disk);
    };
    insert(down, -1);
    insert(up, 1);
  }

  Disk settle(double x, double radius) const {
    double y = infinity;
    while (true) {
      double height = radius;
      const Disk* support = nullptr;
      for (const Disk& disk : down)
        if (const auto h = fall_onto(disk, x, radius); disk.y < y && h && *h > height) height = *h, support = &disk;
      y = std::min(y, height);
      if (support == nullptr) return {x, y, radius};
      const Side side = x >= support->x ? Side::right : Side::left;
      const double sign = static_cast<double>(side), wall = side == Side::right ? width - radius : radius;
      while (support != nullptr) {
        const Disk& pivot = *support;
        const auto later = [&](const Point& p, const Point& q) {
          return -sign * ((p[0] - pivot.x) * (q[1] - pivot.y) - (p[1] - pivot.y) * (q[0] - pivot.x));
        };
        const double reach = radius + pivot.radius;
        Point end{pivot.x + sign * reach, pivot.y};
        bool rests = false;
        if (const double below = radius - pivot.y; below >= 0)
          end = {pivot.x + sign * std::sqrt((reach - below) * (reach + below)), radius}, rests = true;
        if (const double away = std::abs(wall - pivot.x); sign * (end[0] - wall) >= 0)
          end = {wall, pivot.y + std::sqrt(std::max(0.0, (reach - away) * (reach + away)))}, rests = true;
        support = nullptr;
        for (const Disk& disk : up) {
          if (later({x, y}, {disk.x, disk.y}) <= 0) continue;
          const auto centre = roll_against(pivot, disk, radius, side);
          if (centre && later(*centre, end) > 0) end = *centre, support = &disk;
        }
        x = end[0], y = end[1];
        if (support != nullptr ? sign * (support->x - x) >= 0 : rests) return {x, y, radius};
      }
    }
  }
};

// Largest distance between the distribution function of the sample and the one given.
double kolmogorov_distance(std::vector<double> sample, const std::function<double(double)>& cumulative) {
  std::sort(sample.begin(), sample.end());
  const double n = static_cast<double>(sample.size());
  double distance = 0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double f = cumulative(sample[i]);
    distance =
        std::max({distance, std::abs(f - static_cast<double>(i) / n), std::abs(f - static_cast<double>(i + 1) / n)});
  }
  return distance;
}

std::vector<double> sizes_of(const SizeDistribution& sizes, std::uint64_t seed, Index n) {
  const auto radius = radius_quantile(sizes);
  RandomStream random(seed);
  std::vector<double> sample(at(n));
  for (double& r : sample) r = radius(random.uniform());
  return sample;
}

// Grains that a heap places otherwise than the literal one, each on the same bed.
Index places_that_differ(const SizeDistribution& sizes, double width, std::uint64_t seed) {
  constexpr Index grains = 600;
  const std::vector<double> radii = sizes_of(sizes, seed, grains);
  RandomStream random(seed + 1000);
  Heap heap(width, sizes.radius_max, radii);
  LiteralHeap literal{width, std::max(2 * sizes.radius_max, width / (2.0 * grains + 64))};
  Index different = 0;
  for (const double radius : radii) {
    const double x = std::min(radius + random.uniform() * (width - 2 * radius), width - radius);
    const Disk found = heap.settle(x, radius), expected = literal.settle(x, radius);
    different += found.x != expected.x || found.y != expected.y;
    heap.add(expected);
    literal.add(expected);
  }
  return different;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double normal_cumulative(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

// Whether every site of `fewer` is one of `more`. They come sorted: layers upwards, rows upwards, columns to the right.
bool has_sites_of(const Packing& more, const Packing& fewer) {
  const auto sites = [](const Packing& p) {
    std::vector<std::array<double, 3>> all;
    for (Index i = 0; i < p.size(); ++i) all.push_back({p.centre(i)[2], p.centre(i)[1], p.centre(i)[0]});
    return all;
  };
  return std::ranges::includes(sites(more), sites(fewer));
}

// Limits of the Kolmogorov distance of n numbers: exceeded once in 10^4.
double kolmogorov_limit(Index n) { return 2.23 / std::sqrt(static_cast<double>(n)); }

}  // namespace

TEST_CASE("drop and roll: grains come to rest on the floor, at a wall, in a gap, and roll past a top") {
  Heap heap(10, 1, {1, 1, 1, 1, 0.25});
  const auto check_rest = [&](double from, double radius, const auto& x, const auto& y) {
    CAPTURE(from);
    const Disk found = heap.settle(from, radius);
    CHECK((found.x == x && found.y == y));
    heap.add(found);
  };
  using doctest::Approx;
  check_rest(5, 1, 5.0, 1.0);
  check_rest(6, 1, 7.0, 1.0);                               // rolls right over the first, down to the floor
  check_rest(6.9, 1, Approx(6), Approx(1 + std::sqrt(3)));  // rolls left over the second
  check_rest(6.1, 1, Approx(9), 1.0);                       // over the third, over the second, to the floor
  // Over the fourth, into the corner at the wall.
  check_rest(9.75, 0.25, 9.75, Approx(1 + std::sqrt(1.25 * 1.25 - 0.75 * 0.75)));
}

TEST_CASE("drop and roll: cells find the places that trying every grain finds, bit for bit") {
  const auto two_sizes = [](double smallest, double fraction) {
    return SizeDistribution{
        .distribution = "two_sizes", .radius_min = smallest, .radius_max = 1, .fraction_large = fraction};
  };
  const SizeDistribution cases[] = {{.radius_min = 0.5, .radius_max = 1},
                                    {.radius_min = 0.01, .radius_max = 1},
                                    {.distribution = "uniform_volume", .radius_min = 0.01, .radius_max = 1},
                                    {.distribution = "lognormal", .radius_min = 1e-3, .radius_max = 1},
                                    two_sizes(0.5, 0.3),
                                    two_sizes(0.1, 0),  // no grain of the largest size
                                    two_sizes(0.02, 0.002),
                                    two_sizes(0.01, 0.02),
                                    two_sizes(0.001, 0.01)};
  for (const SizeDistribution& sizes : cases)
    for (const double width : watched<double>({2.0, 3.7, 8.0, 30.0}))
      for (const std::uint64_t seed : watched<std::uint64_t>({1, 2})) {
        INFO("distribution = ", sizes.distribution, ", radius_min = ", sizes.radius_min, ", width = ", width);
        CHECK(places_that_differ(sizes, width, seed) == 0);
      }
}

TEST_CASE("drop and roll: the same for equal sizes, where a grain often meets several at one place") {
  for (std::uint64_t seed = 1; seed <= (sanitized ? 6 : 60); ++seed)
    CHECK(places_that_differ({.radius_min = 1, .radius_max = 1}, 8, seed) == 0);
}

TEST_CASE("deposit: no overlap, every grain held on both sides or on the floor") {
  const auto one = [](Index grains, double width, const SizeDistribution& sizes, Index seed) {
    check_deposit({.grains = grains, .width = width, .sizes = sizes, .seed = seed}, width);
  };
  for (const Index seed : {1, 2, 3}) {
    CAPTURE(seed);
    one(3000, 12, {}, seed);
    one(3000, 12, {.radius_min = 0.1, .radius_max = 0.1}, seed);
    one(2000, 10, {.distribution = "uniform_volume", .radius_min = 0.02, .radius_max = 1}, seed);
    one(2000, 10, {.distribution = "two_sizes", .radius_min = 0.05, .radius_max = 0.5}, seed);
    one(2000, 10, {.distribution = "lognormal", .radius_min = 0.05, .radius_max = 0.8, .sigma = 0.6}, seed);
    one(500, 1, {.radius_min = 0.5, .radius_max = 0.5}, seed);    // a column
    one(500, 1.7, {.radius_min = 0.4, .radius_max = 0.5}, seed);  // a staircase
    one(500, 8, {.radius_min = 0.5, .radius_max = 0.5}, seed);    // a box of exactly 8 diameters
    one(500, 5000, {}, seed);                                     // grains far apart
  }
}

TEST_CASE("deposit: the same for sizes and boxes at random, sizes up to 1 : 10^4, boxes of whole diameters") {
  RandomStream random(5);
  for (int trial = 0; trial < (sanitized ? 100 : 1000); ++trial) {
    CAPTURE(trial);
    Deposit deposit{.grains = 1 + random.below(300), .seed = trial};
    const double ratios[] = {1, 1.0000001, 2, 3, std::pow(10.0, 4 * random.uniform())};
    deposit.sizes.radius_min = 0.5;
    deposit.sizes.radius_max = 0.5 * ratios[random.below(5)];
    const char* names[] = {"uniform", "uniform_volume", "two_sizes", "lognormal"};
    deposit.sizes.distribution = names[random.below(4)];
    const double whole = static_cast<double>(1 + random.below(12));
    const double widths[] = {whole, whole * std::numbers::sqrt2, whole + random.uniform()};
    deposit.width = 2 * deposit.sizes.radius_max * widths[random.below(3)];
    check_deposit(deposit, deposit.width);
  }
}

TEST_CASE("deposit: a hundred thousand grains" * doctest::skip(sanitized)) {
  const Packing p = generate(Deposit{.grains = 100'000});
  const ContactNetwork network = detect_contacts(p);
  // Two contacts per grain, fewer only along floor and walls.
  const double coordination = 2.0 * static_cast<double>(network.size()) / 1e5;
  CHECK(coordination > 3.97);
  CHECK(coordination < 4.0);
  const SolidFraction found = solid_fraction(p);
  CHECK(found.middle > found.box);
  double right = 0;
  for (Index i = 0; i < p.size(); ++i) right = std::max(right, p.x[at(i)] + p.radius[at(i)]);
  CHECK(std::abs(std::ranges::max(p.y) / right - 1) < 0.05);  // about as high as wide
}

TEST_CASE("deposit: equal sizes fill as much as beds of this kind are known to" * doctest::skip(sanitized)) {
  // about 0.82 after complete restructuring: Meakin & Jullien, J. Physique 48 (1987) 1651
  const Packing p = generate(Deposit{.grains = 200'000, .sizes = {.radius_min = 0.5, .radius_max = 0.5}});
  CHECK(std::abs(solid_fraction(p).middle - 0.818) < 0.008);
}

TEST_CASE("deposit: equal seeds give equal bytes, others do not, sizes do not depend on the box") {
  const Packing p = generate(Deposit{.grains = 500, .seed = 7});
  CHECK(same_packing(p, generate(Deposit{.grains = 500, .seed = 7})));
  CHECK(same_packing(p, generate(Generator{Deposit{.grains = 500, .seed = 7}})));
  CHECK_FALSE(same_packing(p, generate(Deposit{.grains = 500, .seed = 8})));
  const Packing wide = generate(Deposit{.grains = 500, .width = 30, .seed = 7});
  CHECK(wide.radius == p.radius);
  CHECK(wide.x != p.x);
}

TEST_CASE_TEMPLATE("deposit: a monitor follows, and may stop it", AnyDeposit, Deposit, SphereDeposit) {
  Index last = -1;
  const Packing p = generate(AnyDeposit{.grains = 5000}, [&](Index done, Index total) {
    CHECK(done > last);
    CHECK(total == 5000);
    last = done;
    return done < 2000;
  });
  CHECK(p.size() == last);
  CHECK(p.size() < 5000);
}

TEST_CASE("deposit: a box that cannot hold its grains is refused") {
  CHECK_THROWS_WITH_AS(generate(Deposit{.width = 0.39}), doctest::Contains("packing.width"), Error);
  CHECK_THROWS_WITH_AS(generate(Deposit{.width = 2e6}), doctest::Contains("10^7 radius_min"), Error);
  CHECK(generate(Deposit{.grains = 1}).size() == 1);
  CHECK(generate(Deposit{.grains = 3, .width = 0.4}).size() == 3);
}

TEST_CASE("sizes: mean and distribution are those of the closed forms") {
  constexpr Index n = 200'000;
  const double a = 0.1, b = 0.3;
  SUBCASE("uniform") {
    const auto sample = sizes_of({.radius_min = a, .radius_max = b}, 3, n);
    CHECK(std::abs(mean(sample) - 0.5 * (a + b)) < 4 * (b - a) / std::sqrt(12.0 * n));
    CHECK(kolmogorov_distance(sample, [&](double r) { return (r - a) / (b - a); }) < kolmogorov_limit(n));
  }
  SUBCASE("uniform by volume") {
    const auto sample = sizes_of({.distribution = "uniform_volume", .radius_min = a, .radius_max = b}, 4, n);
    // density c / r^2 with 1/c = 1/a - 1/b: E r = c ln(b/a), E r^2 = c (b - a) = a b
    const double c = 1 / (1 / a - 1 / b), expected = c * std::log(b / a);
    CHECK(std::abs(mean(sample) - expected) < 4 * std::sqrt((a * b - expected * expected) / n));
    CHECK(kolmogorov_distance(sample, [&](double r) { return c * (1 / a - 1 / r); }) < kolmogorov_limit(n));
    // what the name says: the lower and the upper half of the sizes hold the same area
    double lower = 0, all = 0;
    for (const double r : sample) {
      all += r * r;
      if (r < 0.5 * (a + b)) lower += r * r;
    }
    CHECK(lower / all == doctest::Approx(0.5).epsilon(0.01));
  }
  SUBCASE("two sizes") {
    const auto sample =
        sizes_of({.distribution = "two_sizes", .radius_min = a, .radius_max = b, .fraction_large = 0.3}, 5, n);
    const auto large = static_cast<double>(std::count(sample.begin(), sample.end(), b));
    CHECK(std::abs(large - 0.3 * n) < 4 * std::sqrt(0.3 * 0.7 * n));
    CHECK(std::count(sample.begin(), sample.end(), a) + static_cast<Index>(large) == n);
    for (const auto& [fraction, size] : {std::pair{0.0, a}, {1.0, b}}) {
      const auto pure =
          sizes_of({.distribution = "two_sizes", .radius_min = a, .radius_max = b, .fraction_large = fraction}, 5, 100);
      CHECK(std::count(pure.begin(), pure.end(), size) == 100);
    }
  }
  SUBCASE("truncated lognormal: around the median, and in either tail") {
    for (const auto& law : {std::pair{0.18, 0.4}, {0.02, 0.15}, {2.0, 0.2}}) {
      const double median = law.first, sigma = law.second;
      CAPTURE(median);
      const auto sample = sizes_of(
          {.distribution = "lognormal", .radius_min = a, .radius_max = b, .median = median, .sigma = sigma}, 6, n);
      CHECK(*std::min_element(sample.begin(), sample.end()) >= a);
      CHECK(*std::max_element(sample.begin(), sample.end()) <= b);
      // mirrored so that the tail is the lower one, where erfc keeps its digits
      const double sign = median < a ? -1 : 1;
      const auto z = [&](double r) { return sign * std::log(r / median) / sigma; };
      const double low = normal_cumulative(z(a)), high = normal_cumulative(z(b));
      CHECK(kolmogorov_distance(sample, [&](double r) { return (normal_cumulative(z(r)) - low) / (high - low); }) <
            kolmogorov_limit(n));
    }
    // E r = median exp(sigma^2/2) where nothing is cut off
    const auto whole = sizes_of(
        {.distribution = "lognormal", .radius_min = 1e-9, .radius_max = 1e9, .median = 0.2, .sigma = 0.4}, 7, n);
    const double expected = 0.2 * std::exp(0.08);
    CHECK(std::abs(mean(whole) - expected) < 4 * expected * std::sqrt(std::expm1(0.16) / n));
  }
}

TEST_CASE("sizes: one size where the bounds are equal, the geometric mean as default median") {
  for (const char* name : {"uniform", "uniform_volume", "two_sizes", "lognormal"}) {
    CAPTURE(name);
    const auto radius = radius_quantile({.distribution = name, .radius_min = 0.3, .radius_max = 0.3});
    for (const double u : {0.0, 0.4, 0.999999}) CHECK(radius(u) == 0.3);
  }
  CHECK(radius_quantile({.distribution = "lognormal", .radius_min = 0.1, .radius_max = 0.4})(0.5) ==
        doctest::Approx(0.2));
}

TEST_CASE("sizes: what makes no distribution is refused") {
  const auto refused = [](const SizeDistribution& sizes, const char* part) {
    CHECK_THROWS_WITH_AS(radius_quantile(sizes), doctest::Contains(part), Error);
    CHECK_THROWS_AS(generate(Deposit{.sizes = sizes}), Error);
  };
  refused({.radius_min = 0.3, .radius_max = 0.2}, "packing.radius_min: expected at most radius_max = 0.2");
  refused({.radius_min = 0}, "packing.radius_min");
  refused({.radius_max = infinity}, "packing.radius_max");
  refused({.fraction_large = 1.5}, "packing.fraction_large");
  refused({.distribution = "lognormal", .sigma = 0}, "packing.sigma");
  refused({.distribution = "lognormal", .median = 1e9, .sigma = 0.01}, "packing.median");
}

TEST_CASE("hexagonal lattice: without defects as ever") {
  const Packing p = generate(HexagonalLattice{.columns = 3, .rows = 2, .radius = 0.5, .seed = 99});
  CHECK(p.x == std::vector<double>{0, 1, 2, 0.5, 1.5, 2.5});
  CHECK(p.y ==
        std::vector<double>{0, 0, 0, std::numbers::sqrt3 * 0.5, std::numbers::sqrt3 * 0.5, std::numbers::sqrt3 * 0.5});
  CHECK(p.radius == std::vector<double>(6, 0.5));
}

TEST_CASE("hexagonal lattice: as many vacancies as asked, nested, seeded") {
  const auto lattice = [](double vacancies, Index seed) {
    return generate(HexagonalLattice{.columns = 20, .rows = 15, .vacancies = vacancies, .seed = seed});
  };
  CHECK(lattice(0.1, 1).size() == 270);
  CHECK(lattice(0.333, 1).size() == 200);
  CHECK(lattice(0.99, 1).size() == 3);
  CHECK(generate(HexagonalLattice{.columns = 1, .rows = 1, .vacancies = 0.99}).size() == 1);
  CHECK(same_packing(lattice(0.2, 5), lattice(0.2, 5)));
  CHECK_FALSE(same_packing(lattice(0.2, 5), lattice(0.2, 6)));
  CHECK(has_sites_of(lattice(0.1, 1), lattice(0.4, 1)));
  CHECK(has_sites_of(lattice(0, 1), lattice(0.1, 1)));
}

TEST_CASE("hexagonal lattice: size disorder parts neighbours, and a tolerance keeps the network") {
  const HexagonalLattice lattice{.columns = 30, .rows = 30, .radius = 0.5, .disorder = 0.1};
  const Packing p = generate(lattice), full = generate(HexagonalLattice{.columns = 30, .rows = 30});
  CHECK((p.x == full.x && p.y == full.y));
  const auto [low, high] = std::minmax_element(p.radius.begin(), p.radius.end());
  CHECK(*low >= 0.45);
  CHECK(*high <= 0.5);
  CHECK(std::abs(mean(p.radius) - 0.475) < 4 * 0.05 / std::sqrt(12.0 * 900));
  const Index links = detect_contacts(full).size();
  CHECK(detect_contacts(p).size() < links / 100);
  CHECK(detect_contacts(p, {.tolerance = 2 * 0.1 / (1 - 0.1)}).size() == links);
  const Index thinned = detect_contacts(p, {.tolerance = 0.1}).size();
  CHECK(thinned > links / 4);
  CHECK(thinned < links);
  // the sizes of the sites that stay do not depend on the vacancies
  HexagonalLattice holes = lattice;
  holes.vacancies = 0.5;
  const Packing sparse = generate(holes);
  CHECK(sparse.size() == 450);
  for (Index i = 0; i < sparse.size(); ++i)
    CHECK(std::find(p.radius.begin(), p.radius.end(), sparse.radius[at(i)]) != p.radius.end());
}

TEST_CASE("sphere lattices: every neighbour touches to rounding, as many as the closed forms say") {
  const auto check_lattice = [](const auto& lattice, Index contacts, Index most_neighbours) {
    const SphereSites& sites = lattice.sites;
    INFO("columns = ", sites.columns, ", rows = ", sites.rows, ", layers = ", sites.layers);
    const Packing p = generate(lattice);
    check(p);
    REQUIRE(p.size() == sites.columns * sites.rows * sites.layers);
    CHECK(p.dimension() == 3);
    CHECK(p.radius == std::vector<double>(at(p.size()), sites.radius));
    const ContactNetwork network = detect_contacts(p);
    CHECK(network.size() == contacts);
    // rounding of coordinates as large as the lattice, and nothing else
    const double size = sites.radius * static_cast<double>(2 * (sites.columns + sites.rows + sites.layers));
    for (const Contact& contact : network.contacts) CHECK(std::abs(contact.gap) < 2e-15 * size);
    const std::vector<Index> counts = contact_counts(network);
    CHECK(*std::max_element(counts.begin(), counts.end()) <= most_neighbours);
    if (sites.columns > 4 && sites.rows > 4 && sites.layers > 4)
      CHECK(*std::max_element(counts.begin(), counts.end()) == most_neighbours);
  };
  const Index sizes[][3] = {{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}, {2, 2, 2}, {3, 2, 4},
                            {2, 5, 3}, {4, 3, 2}, {5, 6, 5}, {7, 5, 8}, {6, 7, 9}};
  for (const auto& [c, r, l] : sizes)
    for (const double radius : {0.5, 0.3}) {
      const SphereSites sites{.columns = c, .rows = r, .layers = l, .radius = radius};
      check_lattice(CubicLattice{sites}, (c - 1) * r * l + c * (r - 1) * l + c * r * (l - 1), 6);
      check_lattice(FccLattice{sites}, l * ((c - 1) * r + c * (r - 1)) + (l - 1) * (2 * c - 1) * (2 * r - 1), 12);
      check_lattice(HcpLattice{sites},
                    l * (r * (c - 1) + (r - 1) * (2 * c - 1)) +
                        (l - 1) * (r * (2 * c - 1) + c * (r / 2) + (c - 1) * ((r - 1) / 2)),
                    12);
    }
  CHECK_THROWS_AS(generate(FccLattice{{.columns = 1000, .rows = 1000, .layers = 11}}), Error);
  CHECK_THROWS_AS(generate(HcpLattice{{.columns = 100000, .rows = 100000, .layers = 100000}}), Error);
}

TEST_CASE("sphere lattices: layers lie level, fcc in squares and hcp as every second one") {
  const Packing fcc = generate(FccLattice{{.columns = 2, .rows = 2, .layers = 2, .radius = 1}});
  CHECK(fcc.x == std::vector<double>{0, 2, 0, 2, 1, 3, 1, 3});
  CHECK(fcc.y == std::vector<double>{0, 0, 2, 2, 1, 1, 3, 3});
  for (Index i = 0; i < 8; ++i) CHECK(fcc.z[at(i)] == (i < 4 ? 0 : std::numbers::sqrt2));
  const Packing hcp = generate(HcpLattice{{.columns = 3, .rows = 4, .layers = 3, .radius = 0.5}});
  const Packing layer = generate(HexagonalLattice{.columns = 3, .rows = 4, .radius = 0.5});
  for (Index i = 0; i < 12; ++i) {
    CHECK(hcp.x[at(i)] == layer.x[at(i)]);
    CHECK(hcp.y[at(i)] == doctest::Approx(layer.y[at(i)]));
    CHECK(hcp.x[at(24 + i)] == hcp.x[at(i)]);
    CHECK(hcp.y[at(24 + i)] == hcp.y[at(i)]);
    CHECK(hcp.z[at(12 + i)] == doctest::Approx(std::sqrt(2.0 / 3)));
    CHECK(hcp.z[at(24 + i)] == 2 * hcp.z[at(12 + i)]);
  }
}

TEST_CASE("sphere lattices: vacancies and size disorder as in the plane") {
  const SphereSites full{.columns = 6, .rows = 7, .layers = 8};
  SphereSites holes = full, more_holes = full, sizes = full;
  holes.vacancies = 0.1;
  more_holes.vacancies = 0.4;
  sizes.disorder = 0.05;
  const Packing few = generate(FccLattice{holes}), many = generate(FccLattice{more_holes});
  CHECK(few.size() == 336 - 34);
  CHECK(many.size() == 336 - 134);
  CHECK(same_packing(few, generate(FccLattice{holes})));
  CHECK(has_sites_of(few, many));
  CHECK(has_sites_of(generate(FccLattice{full}), few));
  const Packing p = generate(HcpLattice{sizes});
  const auto [low, high] = std::minmax_element(p.radius.begin(), p.radius.end());
  CHECK(*low >= 0.475);
  CHECK(*high <= 0.5);
  const Index links = detect_contacts(generate(HcpLattice{full})).size();
  CHECK(detect_contacts(p).size() < links / 100);
  CHECK(detect_contacts(p, {.tolerance = 2 * 0.05 / (1 - 0.05)}).size() == links);
}

TEST_CASE("generators: each says of which dimension its packings are") {
  for (std::size_t k = 0; k < Alternatives<Generator>::names.size(); ++k) {
    const Generator generator = Alternatives<Generator>::at(k);
    CAPTURE(Alternatives<Generator>::names[k]);
    CHECK(dimension(generator) == generate(generator).dimension());
  }
}
