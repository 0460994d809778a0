// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres dropped into a box: what carries them, exact tangencies, three supports each, work that does not grow.
#include "../support/sanitized.hpp"
#include "../support/small_packings.hpp"
#include "linalg/random.hpp"
#include "packing/sphere_heap.hpp"
#include "packing/statistics.hpp"
#include <nscdd/packing/generator.hpp>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

SpacePoint centre_of(const Packing& p, Index i) { return {p.x[at(i)], p.y[at(i)], p.z[at(i)]}; }

// Where an obstacle is touched, seen from the centre: gap to it and unit vector away from it.
struct Touch {
  double gap;
  SpacePoint normal;
};
Touch touch_of(const SphereBed& bed, Index grain, Index obstacle) {
  const Packing& p = bed.packing;
  const SpacePoint c = centre_of(p, grain);
  const double r = p.radius[at(grain)];
  if (obstacle >= 0) {
    const SpacePoint from = c - centre_of(p, obstacle);
    return {from.norm() - r - p.radius[at(obstacle)], from.normalized()};
  }
  const std::array<Touch, 5> walls{{{c.z() - r, SpacePoint(0, 0, 1)},
                                    {c.x() - r, SpacePoint(1, 0, 0)},
                                    {bed.width - r - c.x(), SpacePoint(-1, 0, 0)},
                                    {c.y() - r, SpacePoint(0, 1, 0)},
                                    {bed.depth - r - c.y(), SpacePoint(0, -1, 0)}}};
  return walls.at(at(-1 - obstacle));
}

// Shares of the points of contact in the place of the centre, seen from above: w_i >= 0, sum 1, sum w_i p_i = c. A
// triangle whose corners lie in line (walls on either side, a crest between them) holds what is on it.
double least_share(const SphereBed& bed, Index grain, const std::vector<Index>& supports) {
  Eigen::Matrix3d corners;
  for (Index k = 0; k < 3; ++k) {
    const SpacePoint n = touch_of(bed, grain, supports[at(k)]).normal;
    corners.col(k) = SpacePoint(-n.x(), -n.y(), 1);
  }
  const SpacePoint shares = corners.fullPivLu().solve(SpacePoint(0, 0, 1));
  if ((corners * shares - SpacePoint(0, 0, 1)).norm() > 1e-9) return -infinity;
  return shares.minCoeff();
}

// Everything a bed promises: in the box, nothing overlaps, supports touch and are found as contacts, three of them hold
// each grain that is not on the floor.
void check_bed(const SphereBed& bed) {
  const Packing& p = bed.packing;
  check(p);
  REQUIRE(p.dimension() == 3);
  REQUIRE(bed.supports.size() == at(p.size()));
  CHECK(bed.work.abandoned == 0);
  // A few roundings of coordinates.
  const double rounding = 1e-15 * std::max({bed.width, bed.depth, std::ranges::max(p.z)});
  const ContactNetwork network = detect_contacts(p, {.tolerance = 1e-9, .overlap_tolerance = 1e-7});
  std::set<std::pair<Index, Index>> found;
  double deepest = 0;
  for (const Contact& contact : network.contacts) {
    deepest = std::min(deepest, contact.gap);
    found.emplace(contact.a, contact.b);
  }
  CHECK(deepest >= -rounding);
  for (Index i = 0; i < p.size(); ++i) {
    CAPTURE(i);
    const double r = p.radius[at(i)];
    if (p.x[at(i)] < r || p.x[at(i)] > bed.width - r || p.y[at(i)] < r || p.y[at(i)] > bed.depth - r || p.z[at(i)] < r)
      FAIL("not in the box");
    const std::vector<Index>& supports = bed.supports[at(i)];
    for (const Index obstacle : supports) {
      if (std::abs(touch_of(bed, i, obstacle).gap) > rounding) FAIL("does not touch ", obstacle);
      if (obstacle >= 0 && !found.contains({obstacle, i})) FAIL("rests on ", obstacle, " and there is no contact");
    }
    if (supports == std::vector<Index>{-1}) continue;
    if (std::set<Index>(supports.begin(), supports.end()).size() != 3) FAIL("expected three supports");
    if (least_share(bed, i, supports) < -1e-9) FAIL("is not above the triangle of its supports");
  }
}

SizeDistribution sizes_between(double a, double b) { return {.radius_min = a, .radius_max = b}; }

// Steepest descent in small steps: down by h, then out of what is in the way, until it gets no lower. Nothing but the
// distances of centres is in it.
SpacePoint creep(const std::vector<Sphere>& bed, double width, double depth, const SpacePoint& start, double radius) {
  const double h = 1e-3 * radius;
  std::vector<std::array<double, 4>> obstacles;  // x, y, z, and how near the centre may come
  for (const Sphere& one : bed)
    obstacles.push_back({one.centre.x(), one.centre.y(), one.centre.z(), radius + one.radius});
  double x = start.x(), y = start.y(), z = start.z();
  std::vector<double> heights;
  for (int step = 0; step < 400'000; ++step) {
    z -= h;
    for (int pass = 0; pass < 200; ++pass) {
      double deepest = 0;
      for (const auto& one : obstacles) {
        const double dx = x - one[0], dy = y - one[1], dz = z - one[2], square = dx * dx + dy * dy + dz * dz;
        if (square >= one[3] * one[3]) continue;
        const double distance = std::sqrt(square), out = one[3] / distance - 1;
        x += out * dx;
        y += out * dy;
        z += out * dz;
        deepest = std::min(deepest, distance - one[3]);
      }
      x = std::min(std::max(x, radius), width - radius);
      y = std::min(std::max(y, radius), depth - radius);
      z = std::max(z, radius);
      if (deepest > -1e-6 * h) break;
    }
    heights.push_back(z);
    if (step >= 2000 && heights[heights.size() - 2001] - z < 1e-2 * h) break;
  }
  return {x, y, z};
}

}  // namespace

TEST_CASE("sphere deposit: what carries a sphere is what the conditions of equilibrium say") {
  const auto lean = [](double x, double y, double z) { return SpacePoint(SpacePoint(x, y, z).normalized()); };
  const auto set_of = [](const Carried& carried) {
    return std::set<std::size_t>(carried.by.begin(),
                                 carried.by.begin() + static_cast<std::ptrdiff_t>(carried.supports));
  };
  const auto of = [](std::vector<SpacePoint> normals) { return carried_by(normals); };
  CHECK(of({}).supports == 0);
  CHECK(of({}).velocity == SpacePoint(0, 0, -1));
  CHECK(of({SpacePoint(1, 0, 0)}).supports == 0);  // it falls along a wall
  CHECK(of({lean(1, 0, -0.1)}).supports == 0);     // and away from what is above
  const Carried slope = of({lean(1, 0, 1)});
  CHECK(slope.supports == 1);
  CHECK((slope.velocity - SpacePoint(0.5, 0, -0.5)).norm() < 1e-15);
  const Carried groove = of({lean(1, 0.2, 1), lean(-1, 0.2, 1)});
  CHECK(groove.supports == 2);
  CHECK(std::abs(groove.velocity.x()) < 1e-15);
  CHECK(groove.velocity.y() > 0);
  CHECK(groove.velocity.z() < 0);
  // of two on the same side, the steeper one lets go
  CHECK(set_of(of({lean(1, 0, 0.2), lean(1, 0, 1)})) == std::set<std::size_t>{1});
  const Carried held = of({lean(1, 0, 2), lean(-1, 1, 2), lean(-1, -1, 2)});
  CHECK(held.supports == 3);
  CHECK(held.velocity == SpacePoint(0, 0, 0));
  // three whose triangle is beside the centre: two of them, or one
  CHECK(set_of(of({lean(1, 1, 2), lean(-1, 1, 2), lean(0.1, 0.9, 1)})) == std::set<std::size_t>{0, 1});
  CHECK(set_of(of({lean(1, 1, 0.5), lean(0.8, 1, 3), lean(1, 0.8, 0.4)})) == std::set<std::size_t>{1});
  // random ones: the conditions themselves
  RandomStream random(5);
  std::array<int, 4> met{};
  const int trials = sanitized ? 2000 : 20'000;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<SpacePoint> normals;
    for (int k = 0; k <= trial % 3; ++k)
      normals.push_back(lean(random.normal(), random.normal(), random.normal() + 0.5));
    const Carried carried = carried_by(normals);
    ++met[carried.supports];
    const SpacePoint& v = carried.velocity;
    const SpacePoint push = v + SpacePoint(0, 0, 1);
    for (const SpacePoint& n : normals) CHECK(n.dot(v) > -1e-12);
    CHECK(std::abs(push.dot(v)) < 1e-12);  // of a projection on a cone
    Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();
    if (carried.supports == 3) {
      for (Index k = 0; k < 3; ++k) basis.col(k) = normals[carried.by[at(k)]];
      CHECK(basis.fullPivLu().solve(SpacePoint(0, 0, 1)).minCoeff() > -1e-12);
    }
  }
  for (const int number : met) CHECK(number > trials / 40);
}

TEST_CASE("sphere deposit: an arc is met where it enters, at once where it goes on inside, never behind") {
  constexpr double pi = std::numbers::pi;
  CHECK(first_crossing(0, 1, 0.5) == doctest::Approx(pi / 6));  // rises from 0 to 1 - 0.5
  CHECK(first_crossing(-1, 0, 1) == doctest::Approx(pi / 2));
  CHECK(first_crossing(0.8, 0.6, 0.2 + 1e-15) == 0);  // touched, and still rising
  CHECK(first_crossing(0.8, -0.6, 0.2) > pi);         // touched, and falling
  CHECK(first_crossing(0, 1, -0.5) == infinity);      // passes by
  CHECK(first_crossing(0, 1, 0) == infinity);
  CHECK(first_crossing(0, 1, 1e-12) == doctest::Approx(pi / 2 - std::sqrt(2e-12)).epsilon(1e-14));
  CHECK(first_crossing(-0.6, -0.8, 0.2) == doctest::Approx(2 * pi - std::atan2(0.8, -0.6) - std::acos(0.8)));
}

TEST_CASE("sphere deposit: places in closed form") {
  const double r = 0.5, far = 20;
  SphereHeap heap(far, far, r, std::vector<double>(5, r));
  const auto settle = [&](double x, double y) { return heap.settle(x, y, r).value(); };
  const auto close = [](const SpacePoint& a, double x, double y, double z) {
    return (a - SpacePoint(x, y, z)).norm() < 1e-14 * 20;
  };
  CHECK(close(settle(10, 10).centre, 10, 10, r));
  CHECK(settle(10, 10).supports == std::vector<Index>{-1});
  heap.add({{10, 10, r}, r});
  CHECK(close(settle(10.3, 10.4).centre, 10.6, 10.8, r));    // down the meridian, to the floor
  CHECK(settle(10, 10).supports == std::vector<Index>{-1});  // exactly on top it rolls off, along x
  CHECK(close(settle(10, 10).centre, 11, 10, r));
  // a corner of the box: two walls and a sphere in the diagonal, then the centre of three
  heap.add({{0.8, 0.8, r}, r});
  const auto corner = settle(0.6, 0.65);
  CHECK(std::set<Index>(corner.supports.begin(), corner.supports.end()) == std::set<Index>{-2, -4, 1});
  CHECK(close(corner.centre, r, r, r + std::sqrt(1 - 2 * 0.09)));
  const double s = std::sqrt(3) / 2;
  heap.add({{11, 10, r}, r});
  heap.add({{10.5, 10 + s, r}, r});
  const auto top = settle(10.4, 10.1);  // a regular tetrahedron
  CHECK(std::set<Index>(top.supports.begin(), top.supports.end()) == std::set<Index>{0, 2, 3});
  CHECK(close(top.centre, 10.5, 10 + s / 3, r + std::sqrt(2.0 / 3)));
  // over the ridge between 0 and 2, down the open side: it leaves the saddle on the circle that touches both
  const auto beside = settle(10.5, 9.9);
  CHECK(beside.supports == std::vector<Index>{-1});
  CHECK(close(beside.centre, 10.5, 10 - s, r));
}

TEST_CASE("sphere deposit: what lies so regularly that nothing decides still ends, at the same place each time") {
  // drops on tops, on ridges, in the middle of four, and between, onto layers of lattices that stand on the floor
  const double r = 0.5, width = 4.5;
  const auto drop_all = [&](const Packing& lattice, double step) {
    SphereBed bed;
    bed.width = bed.depth = width;
    SphereHeap heap(width, width, r, std::vector<double>(100, r)), again = heap;
    Packing& p = bed.packing;
    for (Index i = 0; i < lattice.size(); ++i) {
      const SpacePoint c = centre_of(lattice, i) + SpacePoint(r, r, r);
      if (c.x() > width - r || c.y() > width - r) continue;
      p.x.push_back(c.x());
      p.y.push_back(c.y());
      p.z.push_back(c.z());
      p.radius.push_back(r);
      heap.add({c, r});
      again.add({c, r});
    }
    const Index grain = p.size();
    for (auto* values : {&p.x, &p.y, &p.z, &p.radius}) values->push_back(r);  // the place of the one that is dropped
    for (double x = r; x <= width - r; x += step)
      for (double y = r; y <= width - r; y += step) {
        INFO("x = ", x, ", y = ", y);
        const auto rest = heap.settle(x, y, r);
        REQUIRE(rest);
        CHECK(again.settle(x, y, r)->centre == rest->centre);
        p.x.back() = rest->centre.x();
        p.y.back() = rest->centre.y();
        p.z.back() = rest->centre.z();
        CHECK_NOTHROW(detect_contacts(p, {.tolerance = 1e-13, .overlap_tolerance = 1e-13}));
        if (rest->supports == std::vector<Index>{-1}) continue;
        REQUIRE(rest->supports.size() == 3);
        for (const Index obstacle : rest->supports) CHECK(std::abs(touch_of(bed, grain, obstacle).gap) < 1e-14);
        CHECK(least_share(bed, grain, rest->supports) > -1e-9);
      }
  };
  for (const double step : watched<double>({0.5, 0.25, 0.125})) {
    drop_all(generate(CubicLattice{{.columns = 4, .rows = 4, .layers = 1}}), step);
    drop_all(generate(FccLattice{{.columns = 4, .rows = 4, .layers = 2}}), step);
    drop_all(generate(HcpLattice{{.columns = 4, .rows = 4, .layers = 2}}), step);
    drop_all(generate(FccLattice{{.columns = 4, .rows = 4, .layers = 3, .vacancies = 0.3}}), step);
    drop_all(generate(CubicLattice{{.columns = 4, .rows = 4, .layers = 3, .vacancies = 0.5}}), step);
  }
}

TEST_CASE("sphere deposit: grains are held by three supports or the floor, touch exactly, and stay in the box") {
  const auto of = [](Index grains) { return sanitized ? grains / 10 : grains; };
  for (const Index seed : watched<Index>({1, 2, 3})) {
    CAPTURE(seed);
    check_bed(sphere_bed({.grains = of(3000), .sizes = sizes_between(0.1, 0.2), .seed = seed}));
    check_bed(sphere_bed({.grains = of(3000), .sizes = sizes_between(0.5, 0.5), .seed = seed}));
    check_bed(sphere_bed({.grains = of(2000), .sizes = sizes_between(0.1, 1), .seed = seed}));
  }
  check_bed(sphere_bed({.grains = of(3000), .sizes = {.distribution = "uniform_volume", .radius_max = 1}}));
  check_bed(sphere_bed(
      {.grains = of(5000), .sizes = {.distribution = "two_sizes", .radius_max = 3, .fraction_large = 0.003}}));
  // long ways of small spheres over large ones: what lets go of them must not be met again by rounding
  for (const Index seed : watched<Index>({1, 2, 5, 6}))
    check_bed(sphere_bed({.grains = of(10'000),
                          .width = 7,
                          .sizes = {.distribution = "two_sizes", .radius_max = 3, .fraction_large = 0.003},
                          .seed = seed}));
  check_bed(sphere_bed({.grains = of(2000), .sizes = {.distribution = "lognormal", .radius_max = 0.5, .sigma = 0.5}}));
}

TEST_CASE("sphere deposit: in boxes as narrow as a grain, where walls are touched all the way") {
  for (const double width : watched<double>({0.4, 0.40000001, 0.5, 0.8, 2.0}))
    for (const double depth : watched<double>({0.4, 0.41, 0.8, 5.0}))
      for (const double smallest : {0.1, 0.2}) {
        INFO("width = ", width, ", depth = ", depth);
        const SphereBed bed = sphere_bed(
            {.grains = 300, .width = width, .depth = depth, .sizes = sizes_between(smallest, 0.2), .seed = 4});
        CHECK((bed.width == width && bed.depth == depth));
        check_bed(bed);
      }
  // a column of one grain above the other
  const Packing column =
      generate(SphereDeposit{.grains = 20, .width = 0.4, .depth = 0.4, .sizes = sizes_between(0.2, 0.2)});
  for (Index i = 0; i < 20; ++i) CHECK(column.z[at(i)] == doctest::Approx(0.2 + 0.4 * static_cast<double>(i)));
}

TEST_CASE("sphere deposit: spheres end where small steps down lead them") {
  const double width = 3, depth = 2.5;
  RandomStream random(11);
  std::vector<Sphere> bed;
  SphereHeap heap(width, depth, 0.4, std::vector<double>(150, 0.3));
  int compared = 0, elsewhere = 0;
  for (int i = 0; i < (sanitized ? 33 : 90); ++i) {
    const double radius = 0.2 + 0.2 * random.uniform();
    const auto place = [&](double size) { return radius + random.uniform() * (size - 2 * radius); };
    const double x = place(width), y = place(depth);
    const SpacePoint rest = heap.settle(x, y, radius).value().centre;
    if (i >= 30 && i % 2 == 0) {
      double top = radius;
      for (const Sphere& sphere : bed) top = std::max(top, sphere.centre.z() + sphere.radius + radius);
      ++compared;
      const SpacePoint q = creep(bed, width, depth, {x, y, top}, radius);
      if ((q - rest).norm() > 0.02 * radius) ++elsewhere;
    }
    heap.add({rest, radius});
    bed.push_back({rest, radius});
  }
  CHECK(compared == (sanitized ? 2 : 30));
  CHECK(elsewhere <= 1);  // from a crest, a small step may take the other side
}

TEST_CASE("sphere deposit: cells find the places that trying every grain finds, bit for bit") {
  for (const double largest : {0.1, 0.2, 1.0, 2.0}) {
    CAPTURE(largest);
    constexpr Index grains = sanitized ? 150 : 600;
    const double width = 4.5, depth = 4.2;
    RandomStream random(9);
    std::vector<double> radii(at(grains));
    for (double& r : radii)
      r = largest == 2.0 ? (random.uniform() < 0.02 ? 2.0 : 0.1) : 0.1 + random.uniform() * (largest - 0.1);
    SphereHeap heap(width, depth, largest, radii), all(width, depth, 1000, std::vector<double>(at(grains), 1000.0));
    Index different = 0;
    for (const double r : radii) {
      const double x = r + random.uniform() * (width - 2 * r), y = r + random.uniform() * (depth - 2 * r);
      const auto found = heap.settle(x, y, r), expected = all.settle(x, y, r);
      REQUIRE(found);
      REQUIRE(expected);
      different += found->centre != expected->centre;
      heap.add({expected->centre, r});
      all.add({expected->centre, r});
    }
    CHECK(different == 0);
    CHECK(heap.work().motions == all.work().motions);
    CHECK((sanitized || heap.work().candidates < all.work().candidates / 3));
  }
}

TEST_CASE("sphere deposit: work per grain does not grow with the bed" * doctest::skip(sanitized)) {
  const auto per_grain = [](const SphereDeposit& deposit) {
    const SphereBed bed = sphere_bed(deposit);
    const auto n = static_cast<double>(bed.packing.size());
    CHECK(bed.work.abandoned == 0);
    return std::pair(static_cast<double>(bed.work.motions) / n, static_cast<double>(bed.work.candidates) / n);
  };
  for (const double largest : {0.1, 0.2, 0.5}) {
    CAPTURE(largest);
    const auto small = per_grain({.grains = 3000, .sizes = sizes_between(0.1, largest)});
    const auto large = per_grain({.grains = 40'000, .sizes = sizes_between(0.1, largest)});
    CHECK(large.first < 7);
    CHECK(large.first < 1.1 * small.first);
    // a bed of 3000 has a quarter of its grains at walls and floor, where less is in the way
    CHECK(large.second < 1.4 * small.second);
    CHECK(large.second < 300);
  }
  // and not with the height of a narrow bed either
  const auto tower = [](Index grains) { return SphereDeposit{.grains = grains, .width = 1, .depth = 1}; };
  CHECK(per_grain(tower(20'000)).second < 1.05 * per_grain(tower(2000)).second);
}

TEST_CASE("sphere deposit: beds fill what beds of this kind are known to fill" * doctest::skip(sanitized)) {
  // 0.582 of equal spheres in a wide bed: Visscher & Bolsterli, Nature 239 (1972) 504
  const SphereBed bed = sphere_bed({.grains = 30'000, .sizes = sizes_between(0.5, 0.5)});
  const SolidFraction found = solid_fraction(bed.packing);
  CHECK(std::abs(found.middle - 0.582) < 0.006);
  CHECK(found.box < found.middle);
  // Three supports per grain, fewer along floor and walls alone: as many contacts as grains rest on.
  Index supports = 0;
  for (const auto& held : bed.supports)
    supports += std::count_if(held.begin(), held.end(), [](Index k) { return k >= 0; });
  const ContactNetwork network = detect_contacts(bed.packing);
  CHECK(network.size() >= supports);
  CHECK(network.size() <= supports + 1200);  // a grain that reaches the floor still touches what it rolled over
  CHECK(network.size() > 2.8 * 30'000);
  CHECK(network.size() < 3 * 30'000);
  // About as high as wide.
  CHECK(std::ranges::max(bed.packing.z) / bed.width == doctest::Approx(1.05).epsilon(0.05));
}

TEST_CASE("sphere deposit: equal seeds give equal bytes, others do not, sizes do not depend on the box") {
  const Packing p = generate(SphereDeposit{.grains = 500, .seed = 7});
  CHECK(same_packing(p, generate(SphereDeposit{.grains = 500, .seed = 7})));
  CHECK(same_packing(p, generate(Generator{SphereDeposit{.grains = 500, .seed = 7}})));
  CHECK_FALSE(same_packing(p, generate(SphereDeposit{.grains = 500, .seed = 8})));
  const SphereBed wide = sphere_bed({.grains = 500, .width = 5, .seed = 7});
  CHECK(wide.packing.radius == p.radius);
  CHECK(wide.packing.x != p.x);
  CHECK(wide.depth == 5);
  const SphereBed slab = sphere_bed({.grains = 500, .depth = 0.5, .seed = 7});
  CHECK(slab.packing.radius == p.radius);
  CHECK(std::ranges::max(slab.packing.z) / slab.width == doctest::Approx(1.2).epsilon(0.2));
  // the sizes of the plane
  const Packing disks = generate(Deposit{.grains = 500, .seed = 7});
  CHECK(disks.radius == p.radius);
}

TEST_CASE("sphere deposit: what cannot be is refused by its key") {
  const auto refused = [](const SphereDeposit& deposit, const char* part) {
    CHECK_THROWS_WITH_AS(generate(deposit), doctest::Contains(part), Error);
  };
  refused({.grains = 0}, "packing.grains");
  refused({.grains = -3}, "packing.grains");
  refused({.width = 0.39}, "packing.width: expected 0, or at least 2 radius_max = 0.4 m, met 0.39");
  refused({.depth = 0.39}, "packing.depth: expected 0, or at least 2 radius_max = 0.4 m, met 0.39");
  refused({.width = -1}, "packing.width");
  refused({.depth = not_a_number}, "packing.depth");
  refused({.width = 2e6}, "packing.width: expected at most 10^7 radius_min");
  refused({.width = 1, .depth = 2e6}, "packing.depth: expected at most 10^7 radius_min");
  refused({.sizes = sizes_between(0.3, 0.2)}, "packing.radius_min: expected at most radius_max = 0.2");
  refused({.seed = -1}, "packing.seed");
  CHECK(generate(SphereDeposit{.grains = 1}).size() == 1);
}
