// SPDX-License-Identifier: GPL-3.0-or-later
#include "problems.hpp"

#include "linalg/random.hpp"

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include <algorithm>

namespace nscdd::testing {

Case strip(Index grains) {
  Case one;
  one.spec.name = "strip" + std::to_string(grains);
  one.spec.packing = Generator{TriangularStrip{.grains = grains}};
  one.spec.partition = GridPartitioner{{2, 1}};
  one.spec.prescribed = {{-1, {-1.0, 0.0}}};
  return one;
}

Case random_lattice(std::uint64_t seed, Index columns, Index rows, Components<Index> grid) {
  RandomStream random(seed);
  const Packing full = generate(HexagonalLattice{.columns = columns, .rows = rows, .radius = 0.5});
  Packing packing;
  for (Index i = 0; i < full.size(); ++i) {
    const double mass = 0.5 + random.uniform();
    if (random.uniform() < 0.12 && i + 1 < full.size()) continue;  // a vacancy
    packing.x.push_back(full.x[at(i)]);
    packing.y.push_back(full.y[at(i)]);
    packing.radius.push_back(full.radius[at(i)]);
    packing.mass.push_back(mass);
  }
  Case one;
  one.spec.name = "lattice" + std::to_string(seed);
  one.spec.packing = PackingFile{"made in a test"};
  one.packing = packing;
  one.spec.partition = GridPartitioner{grid};
  one.spec.prescribed = {{0, {1.0, 0.5}}};
  return one;
}

std::vector<Case> plane_problems() {
  std::vector<Case> all{strip(4),
                        strip(8),
                        strip(12),
                        random_lattice(1, 6, 5, {2, 2}),
                        random_lattice(2, 8, 6, {3, 2}),
                        random_lattice(3, 5, 9, {2, 3})};
  Case metis = random_lattice(4, 7, 6, {1, 1});
  metis.spec.name = "metis";
  metis.spec.partition = MetisPartitioner{.metis = 4, .seed = 1};
  all.push_back(metis);
  Case fine = strip(6);
  fine.spec.name = "empty cells";
  fine.spec.partition = GridPartitioner{{30, 3}};
  all.push_back(fine);
  return all;
}

std::vector<Case> every_problem() {
  std::vector<Case> all = plane_problems();
  const std::vector<Case> space = spatial_problems();
  all.insert(all.end(), space.begin(), space.end());
  return all;
}

std::vector<Case> with_interface(std::vector<Case> all) {
  std::erase_if(all, [](const Case& one) { return build(one).parts.interface_size() == 0; });
  return all;
}

void on_every_interface(const std::function<void(const Model&)>& law) {
  int problems = 0;
  for (const Case& one : with_interface(every_problem())) {
    CAPTURE(one.spec.name);
    law(build(one));
    ++problems;
  }
  CHECK(problems >= 14);
}

Case renumbered(const Case& one, std::uint64_t seed) {
  const Packing before = build(one).packing;
  std::vector<Index> order = natural_order(before.size());
  RandomStream random(seed);
  for (Index i = before.size() - 2; i > 0; --i) std::swap(order[at(i)], order[at(random.below(i + 1))]);
  Packing after;
  for (const Index i : order) {
    after.x.push_back(before.x[at(i)]);
    after.y.push_back(before.y[at(i)]);
    if (before.dimension() == 3) after.z.push_back(before.z[at(i)]);
    after.radius.push_back(before.radius[at(i)]);
    after.mass.push_back(before.mass[at(i)]);
  }
  Case result = one;
  result.spec.packing = PackingFile{"renumbered"};
  result.packing = after;
  for (PrescribedVelocity& velocity : result.spec.prescribed) {
    if (velocity.grain < 0) velocity.grain += before.size();
    velocity.grain = std::find(order.begin(), order.end(), velocity.grain) - order.begin();
  }
  return result;
}

Model moved(const Case& one, double angle, double shift_x, double shift_y) {
  Model model = build(one);
  Packing packing = model.packing;
  const bool space = packing.dimension() == 3;
  const Eigen::Vector3d axis = space ? Eigen::Vector3d(1, 2, 2) / 3 : Eigen::Vector3d(0, 0, 1);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  for (Index i = 0; i < packing.size(); ++i) {
    const auto [x, y, z] = packing.centre(i);
    const Eigen::Vector3d turned = turn * Eigen::Vector3d(x, y, z);
    packing.x[at(i)] = turned[0] + shift_x;
    packing.y[at(i)] = turned[1] + shift_y;
    if (space) packing.z[at(i)] = turned[2] - shift_x;
  }
  std::vector<PrescribedVelocity> prescribed = one.spec.prescribed;
  for (PrescribedVelocity& velocity : prescribed) {
    if (velocity.grain < 0) velocity.grain += packing.size();
    const Components<double>& v = velocity.velocity;
    const Eigen::Vector3d turned = turn * Eigen::Vector3d(v[0], v[1], v[2]);
    velocity.velocity = {turned[0], turned[1]};
    if (space) velocity.velocity = {turned[0], turned[1], turned[2]};
  }
  model.packing = packing;
  model.network = detect_contacts(packing, one.spec.contacts);
  model.problem = assemble(packing, model.network, prescribed);
  model.parts = decompose(model.problem, model.partition);
  return model;
}

std::vector<Vector> impact_loads(const Decomposition& parts, const Vector& arriving_velocity) {
  std::vector<Vector> loads;
  const Index d = parts.dofs_per_grain();
  for (const Subdomain& subdomain : parts.subdomains) {
    Vector& load = loads.emplace_back(subdomain.inertia);
    for (Index i = 0; i < count(subdomain.grains); ++i)
      load.segment(d * i, d).array() *= arriving_velocity.segment(d * subdomain.grains[at(i)], d).array();
  }
  return loads;
}

Index cross_points(const Decomposition& parts) {
  Index result = 0;
  for (Index grain = 0; grain < parts.interface.grains(); ++grain) result += parts.interface.multiplicity(grain) > 2;
  return result;
}

}  // namespace nscdd::testing
