// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/step_friction.hpp"

#include <vector>

namespace nscdd {
namespace {

constexpr Index dofs = 3;

// First row of every body, -1 for a driven one.
std::vector<Index> rows_of(std::span<const DiskVelocity> bodies) {
  std::vector<Index> rows;
  Index next = 0;
  for (const DiskVelocity& body : bodies) {
    rows.push_back(body.inverse_mass > 0 ? next : -1);
    if (body.inverse_mass > 0) next += dofs;
  }
  return rows;
}

SparseMatrix diagonal(const Vector& values) {
  SparseMatrix matrix(values.size(), values.size());
  matrix.reserve(Eigen::VectorXi::Constant(values.size(), 1));
  for (Index i = 0; i < values.size(); ++i) matrix.insert(i, i) = values[i];
  matrix.makeCompressed();
  return matrix;
}

SparseMatrix contact_directions(std::span<const DiskContact> contacts, const std::vector<Index>& row_of,
                                std::span<const double> radius, Index rows) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(10 * contacts.size());
  const auto put = [&](Index row, Index column, double value) {
    entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  };
  for (Index c = 0; c < static_cast<Index>(contacts.size()); ++c) {
    const DiskContact& k = contacts[at(c)];
    for (const auto& [body, sign] : {std::pair(Index{k.a}, -1.0), std::pair(Index{k.b}, 1.0)}) {
      const Index row = row_of[at(body)];
      if (row < 0) continue;
      const auto normal = impulse_on_disk(k, sign, {1, 0}), tangent = impulse_on_disk(k, sign, {0, 1});
      put(row, 2 * c, normal[0]);
      put(row + 1, 2 * c, normal[1]);
      put(row, 2 * c + 1, tangent[0]);
      put(row + 1, 2 * c + 1, tangent[1]);
      put(row + 2, 2 * c + 1, radius[at(body)] * tangent[2]);  // both arms are radii: rims move alike
    }
  }
  SparseMatrix h(rows, 2 * static_cast<Index>(contacts.size()));
  h.setFromTriplets(entries.begin(), entries.end());
  return h;
}

}  // namespace

GlobalFrictionProblem friction_problem(std::span<const DiskVelocity> bodies,
                                       std::span<const DiskContact> contacts,
                                       std::span<const double> radius) {
  const std::vector<Index> row_of = rows_of(bodies);
  std::vector<double> inertia, momentum;
  std::vector<DiskVelocity> driven(bodies.begin(), bodies.end());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (row_of[i] < 0) continue;
    const DiskVelocity& v = bodies[i];
    const double m = 1 / v.inverse_mass, rim_mass = m / rim_mass_ratio;
    inertia.insert(inertia.end(), {m, m, rim_mass * radius[i] * radius[i]});
    momentum.insert(momentum.end(), {m * v.x, m * v.y, rim_mass * radius[i] * v.rim});
    driven[i].x = driven[i].y = driven[i].rim = 0;
  }
  const Index rows = count(inertia), size = static_cast<Index>(contacts.size());
  GlobalFrictionProblem problem;
  problem.mass = diagonal(Vector::Map(inertia.data(), rows));
  problem.f = Vector::Map(momentum.data(), rows);
  problem.h = contact_directions(contacts, row_of, radius, rows);
  problem.w.resize(2 * size);
  problem.friction.resize(size);
  for (Index c = 0; c < size; ++c) {
    const DiskContact& k = contacts[at(c)];
    const LocalVector u = relative_velocity(k, driven);
    problem.w[2 * c] = u.n + k.bias_n;
    problem.w[2 * c + 1] = u.t + k.bias_t;
    problem.friction[c] = k.friction;
  }
  return problem;
}

}  // namespace nscdd
