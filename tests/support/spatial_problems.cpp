// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial_problems.hpp"

#include "linalg/random.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <deque>

namespace nscdd::testing {
namespace {

using Point = Eigen::Vector3d;

struct Sphere {
  Point centre;
  double radius;
};

Case spheres(const std::string& name, const std::vector<Sphere>& all, const Partitioner& partition) {
  Case one;
  one.spec.name = name;
  one.spec.packing = PackingFile{"made in a test"};
  for (const auto& [centre, radius] : all) {
    one.packing.x.push_back(centre[0]);
    one.packing.y.push_back(centre[1]);
    one.packing.z.push_back(centre[2]);
    one.packing.radius.push_back(radius);
  }
  one.spec.partition = partition;
  one.spec.prescribed = {{-1, {-1.0, 0.25, -0.5}}};
  return one;
}

void draw_masses(Case& one, RandomStream& random) {
  for (Index i = 0; i < one.packing.size(); ++i) one.packing.mass.push_back(0.5 + random.uniform());
}

// Both points at the distances from three others, by their local axes; none where the distances do not meet.
std::vector<Point> trilateration(const std::array<Point, 3>& at, const std::array<double, 3>& distance) {
  const Point ex = (at[1] - at[0]).normalized(), to_third = at[2] - at[0];
  const Point ey = (to_third - to_third.dot(ex) * ex).normalized();
  const double d = (at[1] - at[0]).norm(), i = to_third.dot(ex), j = to_third.dot(ey);
  const auto square = [](double x) { return x * x; };
  const double x = (square(distance[0]) - square(distance[1]) + square(d)) / (2 * d);
  const double y = (square(distance[0]) - square(distance[2]) + square(i) + square(j) - 2 * i * x) / (2 * j);
  const double height = square(distance[0]) - square(x) - square(y);
  if (height <= 0) return {};
  const Point foot = at[0] + x * ex + y * ey, up = std::sqrt(height) * ex.cross(ey);
  return {foot + up, foot - up};
}

// Where a sphere touches three others and nothing else.
std::optional<Sphere> on_three(const std::vector<Sphere>& all, const std::array<std::size_t, 3>& face, double radius) {
  std::array<Point, 3> centres;
  std::array<double, 3> distances;
  for (std::size_t k = 0; k < 3; ++k) {
    centres[k] = all[face[k]].centre;
    distances[k] = all[face[k]].radius + radius;
  }
  for (const Point& place : trilateration(centres, distances)) {
    bool fits = true;
    for (std::size_t k = 0; k < all.size(); ++k)
      fits = fits && (std::ranges::count(face, k) > 0 ||
                      (all[k].centre - place).norm() > (1 + 1e-3) * (all[k].radius + radius));
    if (fits) return Sphere{place, radius};
  }
  return std::nullopt;
}

}  // namespace

Case two_tetrahedra() {
  const double third = std::sqrt(3.0) / 6, height = std::sqrt(2.0 / 3.0);
  return spheres("two tetrahedra",
                 {{{0, 0, 0}, 0.5},
                  {{1, 0, 0}, 0.5},
                  {{0.5, 3 * third, 0}, 0.5},
                  {{0.5, third, -height}, 0.5},
                  {{0.5, third, height}, 0.5}},
                 GridPartitioner{{1, 1, 2}});
}

Case octahedron() {
  std::vector<Sphere> all;
  for (const int axis : {0, 1, 2})
    for (const double side : {-1.0, 1.0}) all.push_back({side * std::sqrt(0.5) * Point::Unit(axis), 0.5});
  return spheres("octahedron", all, GridPartitioner{{2, 1, 1}});
}

Case sphere_cluster(std::uint64_t seed, Index grains, const Partitioner& partition) {
  RandomStream random(seed);
  const auto radius = [&] { return 0.4 + 0.2 * random.uniform(); };
  std::vector<Sphere> all{{{0, 0, 0}, 0.5}, {{1, 0, 0}, 0.5}, {{0.5, std::sqrt(0.75), 0}, 0.5}};
  std::deque<std::array<std::size_t, 3>> faces{{0, 1, 2}, {0, 1, 2}};
  while (count(all) < grains) {
    const std::size_t k = at(random.below(std::min<Index>(count(faces), 12)));  // old faces first: a round cluster
    const auto face = faces[k];
    const auto next = on_three(all, face, radius());
    if (!next) {
      if (random.uniform() < 0.2) faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(k));
      continue;
    }
    const std::size_t number = all.size();
    all.push_back(*next);
    for (std::size_t left = 0; left < 3; ++left) faces.push_back({face[left], face[(left + 1) % 3], number});
  }
  Case one = spheres("cluster" + std::to_string(seed), all, partition);
  draw_masses(one, random);
  return one;
}

Case random_fcc(std::uint64_t seed, Index sites_x, Index sites_y, Index sites_z, const Partitioner& partition) {
  RandomStream random(seed);
  std::vector<Sphere> all;
  const double step = std::sqrt(0.5);  // half of an edge of the cubic cell
  for (Index k = 0; k < sites_z; ++k)
    for (Index j = 0; j < sites_y; ++j)
      for (Index i = 0; i < sites_x; ++i) {
        if ((i + j + k) % 2 != 0 || random.uniform() < 0.12) continue;  // a vacancy
        all.push_back({step * Point(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)), 0.5});
      }
  Case one = spheres("fcc" + std::to_string(seed), all, partition);
  draw_masses(one, random);
  return one;
}

Case disordered_fcc(std::uint64_t seed, double vacancies, const Partitioner& partition) {
  RandomStream random(seed);
  std::vector<Sphere> all;
  const double step = std::sqrt(0.5);
  for (Index k = 0; k < 8; ++k)
    for (Index j = 0; j < 11; ++j)
      for (Index i = 0; i < 11; ++i) {
        if ((i + j + k) % 2 != 0 || random.uniform() < vacancies) continue;
        const Point site{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        const auto moved = [&] { return 0.01 * random.uniform() - 0.005; };
        const double x = moved(), y = moved(), z = moved();
        all.push_back({step * site + Point(x, y, z), 0.5});
      }
  Case one = spheres("disordered" + std::to_string(seed), all, partition);
  one.spec.contacts.tolerance = one.spec.contacts.overlap_tolerance = 0.05;
  return one;
}

Case flat(const Case& plane) {
  Case one = plane;
  one.packing = packing_of(plane);
  one.packing.z.assign(at(one.packing.size()), 0.0);
  one.spec.name += " in space";
  one.spec.packing = PackingFile{"made in a test"};
  for (PrescribedVelocity& prescribed : one.spec.prescribed) {
    const Components<double> v = prescribed.velocity;
    prescribed.velocity = {v[0], v[1], 0};
  }
  if (one.spec.loads.compress()) {
    const Components<double> c = one.spec.loads.compression;
    one.spec.loads.compression = {c[0], c[1], 0};
  }
  if (auto* grid = std::get_if<GridPartitioner>(&one.spec.partition)) {
    const Components<Index> cells = grid->grid;
    grid->grid = {cells[0], cells[1], 1};
  }
  return one;
}

std::vector<Case> spatial_problems() {
  std::vector<Case> all{two_tetrahedra(),
                        octahedron(),
                        sphere_cluster(1, 24, GridPartitioner{{2, 2, 2}}),
                        sphere_cluster(2, 30, GridPartitioner{{1, 3, 2}}),
                        random_fcc(1, 4, 4, 4, GridPartitioner{{2, 2, 2}}),
                        random_fcc(2, 5, 4, 3, GridPartitioner{{3, 1, 1}})};
  Case metis = random_fcc(3, 4, 4, 4, MetisPartitioner{.metis = 4, .seed = 1});
  metis.spec.name = "metis";
  all.push_back(metis);
  return all;
}

}  // namespace nscdd::testing
