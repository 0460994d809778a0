// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/step_friction.hpp"

#include "mechanics/connectivity.hpp"

#include <vector>

namespace nscdd {
namespace {

// Three rows for every free body; lever arms are radii (walls, which have none, are driven).
std::vector<BodyRows> rows_of(std::span<const DiskVelocity> bodies, std::span<const double> radius) {
  std::vector<BodyRows> rows(bodies.size());
  Index next = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].inverse_mass == 0) continue;
    rows[i] = {next, radius[i]};
    next += 3;
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

}  // namespace

GlobalFrictionProblem friction_problem(std::span<const DiskVelocity> bodies, std::span<const DiskContact> contacts,
                                       std::span<const double> radius) {
  const std::vector<BodyRows> row_of = rows_of(bodies, radius);
  std::vector<double> inertia, momentum;
  std::vector<DiskVelocity> driven(bodies.begin(), bodies.end());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (row_of[i].first < 0) continue;
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
  problem.w.resize(2 * size);
  problem.friction.resize(size);
  ConnectivityBuilder h(2 * contacts.size());
  for (Index c = 0; c < size; ++c) {
    const DiskContact& k = contacts[at(c)];
    for (const LocalVector direction : {LocalVector{1, 0}, LocalVector{0, 1}})
      h.add(k.normal(), row_of[at(k.a)], row_of[at(k.b)], direction);
    const LocalVector u = relative_velocity(k, driven);
    problem.w[2 * c] = u.n + k.bias_n;
    problem.w[2 * c + 1] = u.t + k.bias_t;
    problem.friction[c] = k.friction;
  }
  problem.h = h.matrix(rows);
  return problem;
}

}  // namespace nscdd
