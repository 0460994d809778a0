// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/clumps.hpp"

#include "core/fail.hpp"

#include <Eigen/Eigenvalues>

#include <map>
#include <set>

namespace nscdd {
namespace {

// The moment of inertia of a mass at a place about the origin.
Matrix3 inertia_at(const Vector3& place, double mass) {
  return mass * (place.squaredNorm() * Matrix3::Identity() - place * place.transpose());
}

BoundarySpec clump(const Packing& packing, const Period& period, Index number, const std::vector<Index>& members) {
  const bool space = packing.dimension() == 3;
  const Place origin = packing.centre(members.front());
  FreeBody body;
  Vector3 centre = Vector3::Zero();
  Matrix3 inertia = Matrix3::Zero();
  for (const Index i : members) {
    const double mass = packing.mass[at(i)], radius = packing.radius[at(i)];
    const Place apart = period.shortest(difference(packing.centre(i), origin));
    const Vector3 place(apart.data());
    body.mass += mass;
    centre += mass * place;
    inertia += inertia_at(place, mass) + (space ? 0.4 : 0.5) * mass * radius * radius * Matrix3::Identity();
  }
  centre /= body.mass;
  inertia -= inertia_at(centre, body.mass);
  body.inertia = {0, 0, inertia(2, 2)};
  body.directions = {true, true, space, space, space, true};
  if (space) {
    const Eigen::SelfAdjointEigenSolver<Matrix3> principal(inertia);
    Matrix3 axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(2) *= -1;
    body.axes = Eigen::Quaterniond(axes).normalized();
    Vector3::Map(body.inertia.data()) = principal.eigenvalues();
  }
  BoundarySpec spec;
  spec.name = fmt::format("clump {}", number);
  spec.shape = BoundaryShape::grains;
  spec.dimension = packing.dimension();
  if (members.back() - members.front() + 1 == count(members))
    std::tie(spec.first, spec.last) = std::pair(members.front(), members.back());
  else
    spec.grains = members;
  spec.motion.centre = moved_along(origin, 1, {centre[0], centre[1], centre[2]});
  spec.body = body;
  return spec;
}

}  // namespace

std::vector<BoundarySpec> clumps_of(const Packing& packing, const Period& period) {
  std::map<Index, std::vector<Index>> members;
  for (Index i = 0; i < count(packing.clump); ++i)
    if (packing.clump[at(i)] >= 0) members[packing.clump[at(i)]].push_back(i);
  std::vector<BoundarySpec> bodies;
  for (const auto& [number, grains] : members) bodies.push_back(clump(packing, period, number, grains));
  return bodies;
}

void add_clumps(std::vector<BoundarySpec>& boundaries, const Packing& packing, const Period& period) {
  std::vector<Index> taken(at(packing.size()), -1);  // the boundary of a grain
  std::set<std::string> names;
  for (Index k = 0; k < count(boundaries); ++k) {
    const BoundarySpec& one = boundaries[at(k)];
    names.insert(one.name);
    const Index whole =
        one.part ? std::ranges::find(boundaries, one.name, &BoundarySpec::name) - boundaries.begin() : k;
    if (one.shape == BoundaryShape::grains)
      for (const Index i : grains_of(one, k, packing.size())) taken[at(i)] = whole;
  }
  for (BoundarySpec& body : clumps_of(packing, period)) {
    const std::vector<Index> own = grains_of(body, 0, packing.size());
    std::set<Index> owners;
    for (const Index i : own) owners.insert(taken[at(i)]);
    if (owners.size() > 1)
      fail("{}: expected all of its {} grains in one boundary of the case or none, met {} in {}", body.name, own.size(),
           std::ranges::count_if(own, [&](Index i) { return taken[at(i)] >= 0; }), owners.size() - owners.count(-1));
    if (!owners.contains(-1)) {
      if (const BoundarySpec& owner = boundaries[at(*owners.begin())]; owner.source)
        fail("boundary '{}': release: expected grains that are no parts of clumps, met those of {}", owner.name,
             body.name);
      continue;
    }
    if (names.contains(body.name)) fail("boundary '{}': expected another name, met that of a clump", body.name);
    boundaries.push_back(std::move(body));
  }
}

}  // namespace nscdd
