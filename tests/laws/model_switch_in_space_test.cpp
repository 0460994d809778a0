// SPDX-License-Identifier: GPL-3.0-or-later
// Subdomains of spheres that become linear while their statuses stand still: what they answer, that a run comes to the
// same end with them, and that a contact that slides with friction keeps its subdomain as it is.
#include "../support/dense.hpp"
#include "../support/spheres.hpp"
#include "two_stage/model_switch.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Dynamics divided(SwitchedModel model, double friction) {
  Dynamics dynamics = tight({plane("floor", Vector3::Zero(), Vector3::UnitZ())});
  dynamics.interaction.friction = friction;
  dynamics.solver = switching(model);
  return dynamics;
}

// A crooked column of spheres that is about to topple, sideways and out of its plane: every contact sticks.
Simulation column_of_spheres(SwitchedModel model) {
  std::vector<Ball> balls;
  for (int k = 0; k < 8; ++k)
    balls.push_back(
        {.centre = {k % 2 == 0 ? 0.0 : 0.16, k % 2 == 0 ? 0.0 : 0.12, 0.5 + std::sqrt(0.96) * k}, .mass = 1 + 0.1 * k});
  return simulation_of(balls, divided(model, 2), {1, 1, 4});
}

// M (V - V_0) = G d, N^T V + bias = -alpha d as one dense system in V and d, where contacts stick in all three
// directions, or keep v_n = 0 alone. Each direction is a unit impulse, or a unit velocity, of the contact.
std::vector<GrainVelocity<3>> frozen_by_hand(const GranularSubdomain<3>& subdomain,
                                             const std::vector<ContactStatus>& statuses, double alpha) {
  const Index n = 6 * count(subdomain.velocities);
  std::vector<Vector> directions;
  std::vector<double> bias;
  for (std::size_t k = 0; k < statuses.size(); ++k) {
    if (statuses[k] == ContactStatus::open) continue;
    const GrainContact<3> c = subdomain.contacts.contact(k, subdomain.velocities);
    const Vector3 normal(c.normal[0], c.normal[1], c.normal[2]);
    const Vector3 side = normal.unitOrthogonal();
    std::vector<Vector3> axes{normal};
    if (statuses[k] == ContactStatus::stick) axes.insert(axes.end(), {side, normal.cross(side)});
    for (const Vector3& axis : axes) {
      Vector h = Vector::Zero(n);
      h.segment<3>(6 * c.a) = -axis;
      h.segment<3>(6 * c.b) = axis;
      h.segment<3>(6 * c.a + 3) = h.segment<3>(6 * c.b + 3) = -normal.cross(axis);
      directions.push_back(h);
      bias.push_back(axis.dot(normal) * c.bias.n);
    }
  }
  const Index columns = count(directions);
  Matrix system = Matrix::Zero(n + columns, n + columns);
  Vector right = Vector::Zero(n + columns), start(n);
  for (Index i = 0; i < count(subdomain.velocities); ++i) {
    const GrainVelocity<3>& v = subdomain.velocities[at(i)];
    const GrainUnknowns<3> own = unknowns(v);
    const double mass = v.inverse_mass > 0 ? 1 / v.inverse_mass : 1;
    for (Index k = 0; k < 6; ++k) {
      system(6 * i + k, 6 * i + k) = k < 3 ? mass : 0.4 * mass;
      start[6 * i + k] = own[at(k)];
    }
  }
  for (Index j = 0; j < columns; ++j) {
    const Vector& h = directions[at(j)];
    for (Index row = 0; row < n; ++row)
      if (subdomain.velocities[at(row / 6)].inverse_mass > 0) system(row, n + j) = -h[row];
    system.block(n + j, 0, 1, n) = h.transpose();
    system(n + j, n + j) = alpha;
    right[n + j] = -bias[at(j)] - h.dot(start);
  }
  const Vector change = solve(Dense(system), right);
  std::vector<GrainVelocity<3>> moved = subdomain.velocities;
  for (Index i = 0; i < count(moved); ++i) {
    GrainUnknowns<3> own = unknowns(moved[at(i)]);
    for (Index k = 0; k < 6; ++k) own[at(k)] += change[6 * i + k];
    moved[at(i)] = with_unknowns(own, moved[at(i)].inverse_mass);
  }
  return moved;
}

Index linear_iterations(const GranularStep<3>& step) {
  Index sum = 0;
  for (const RememberedModel& model : step.models) sum += model.switched_iterations;
  return sum;
}

}  // namespace

TEST_CASE("a linear subdomain of spheres answers what a dense solve of its frozen network does") {
  // With friction 0 contacts slide in every direction, and none turns.
  for (const double friction : {2.0, 0.0}) {
    CAPTURE(friction);
    Dynamics slippery = divided(SwitchedModel::none, 0);
    slippery.boundaries.clear();
    const Simulation simulation =
        friction > 0 ? column_of_spheres(SwitchedModel::none) : shaken_cube(3, slippery, {2, 1, 1});
    PreparedStep<3> step = prepare_solution<3>(simulation);
    for (int k = 0; k < 300; ++k) step.iteration.iterate();
    Index frozen = 0;
    for (GranularSubdomain<3> subdomain : step.iteration.parts().subdomains) {
      const auto statuses = statuses_of(step.share.problem.law, subdomain);
      frozen += count(statuses) - std::ranges::count(statuses, ContactStatus::open);
      if (friction > 0) REQUIRE(std::ranges::count(statuses, ContactStatus::slide) == 0);
      for (const double alpha : {1e-2, 1e-6}) {
        LinearSubdomain<3> linear(subdomain, step.share.problem.law, statuses, alpha * step.share.problem.scale);
        REQUIRE(linear.regular());
        for (int push = 0; push < 2; ++push) {
          GranularSubdomain<3> pushed = subdomain;  // as Stage 2 does
          for (GrainVelocity<3>& v : pushed.velocities)
            if (push == 1 && v.inverse_mass > 0) v.rim_y += v.z += v.y += 0.01;
          const LinearAnswer<3> answer = linear.answer(pushed);
          const auto by_hand = frozen_by_hand(pushed, statuses, alpha * step.share.problem.scale);
          CHECK(largest_difference(answer.velocities, by_hand) < 1e-8);
        }
      }
    }
    CHECK(frozen > 5);
  }
}

TEST_CASE("spheres whose statuses stand still: a run that switches comes to the velocities of one that does not") {
  Simulation plain = column_of_spheres(SwitchedModel::none), switched = column_of_spheres(SwitchedModel::linear);
  Index linear = 0, iterations = 0;
  for (int k = 0; k < 12; ++k) {
    const GranularStep<3> a = solve_step<3>(plain), b = solve_step<3>(switched);
    REQUIRE(a.report.status == SolverStatus::converged);
    REQUIRE(b.report.status == SolverStatus::converged);
    CHECK(largest_difference(a.velocities, b.velocities) < 1e-6);
    linear += linear_iterations(b);
    iterations += b.report.last.iteration;
    take_step(plain, a);
    take_step(switched, b);
  }
  CHECK(linear > iterations);  // of four subdomains
}

TEST_CASE("spheres that slide with friction keep their subdomain as it is; without friction it becomes linear") {
  for (const double friction : {0.05, 0.0}) {
    CAPTURE(friction);
    Dynamics dynamics = divided(SwitchedModel::linear, friction);
    dynamics.solver.tolerance = dynamics.solver.gluing_tolerance = 1e-9;
    dynamics.boundaries.clear();
    const Simulation switched = shaken_cube(4, dynamics, {2, 2, 1});
    Simulation plain = switched;
    plain.dynamics.solver.model = SwitchedModel::none;
    const GranularStep<3> a = solve_step<3>(plain), b = solve_step<3>(switched);
    REQUIRE(a.report.status == SolverStatus::converged);
    CHECK(a.report.residual.slide > 10);
    if (friction > 0) {
      // Every subdomain has such a contact, so that no bit differs.
      CHECK(linear_iterations(b) == 0);
      CHECK(largest_difference(a.velocities, b.velocities) == 0);
    } else {
      CHECK(linear_iterations(b) > b.report.last.iteration);
      CHECK(largest_difference(a.velocities, b.velocities) < 1e-6);
    }
  }
}

TEST_CASE("homogenised subdomains are refused in space") {
  Simulation simulation = column_of_spheres(SwitchedModel::homogenised);
  CHECK_THROWS_WITH_AS(prepare_solution<3>(simulation), doctest::Contains("expected none or linear"), Error);
}
