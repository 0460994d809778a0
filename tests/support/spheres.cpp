// SPDX-License-Identifier: GPL-3.0-or-later
#include "spheres.hpp"

#include "linalg/random.hpp"

#include <doctest/doctest.h>

namespace nscdd::testing {

BoundarySpec plane(const std::string& name, const Vector3& point, const Vector3& normal, Motion motion) {
  return {.name = name,
          .dimension = 3,
          .point = {point[0], point[1], point[2]},
          .normal = {normal[0], normal[1], normal[2]},
          .motion = std::move(motion)};
}

BoundarySpec cylinder(const std::string& name, const Vector3& from, const Vector3& to, double radius,
                      CylinderSide side) {
  return {.name = name,
          .shape = BoundaryShape::cylinder,
          .dimension = 3,
          .from = {from[0], from[1], from[2]},
          .to = {to[0], to[1], to[2]},
          .radius = radius,
          .side = side,
          .motion = {}};
}

Motion moving_in_space(const Vector3& velocity, const Vector3& spin, const Vector3& centre) {
  return {.centre = {centre[0], centre[1], centre[2]},
          .time = {0},
          .velocity = {{velocity[0], velocity[1], spin[2], velocity[2], spin[0], spin[1]}}};
}

Simulation simulation_of(const std::vector<Ball>& balls, const Dynamics& dynamics, Components<Index> grid) {
  Packing packing;
  for (const Ball& ball : balls) {
    packing.x.push_back(ball.centre[0]);
    packing.y.push_back(ball.centre[1]);
    packing.z.push_back(ball.centre[2]);
    packing.radius.push_back(ball.radius);
    packing.mass.push_back(ball.mass);
  }
  GranularScene made = scene(packing, dynamics);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Vector3 &v = balls[i].velocity, rim = balls[i].radius * balls[i].spin;
    set_motion(made.state, i, {v[0], v[1], v[2], rim[0], rim[1], rim[2]}, balls[i].radius);
  }
  return {made.system, made.state, dynamics, GridPartitioner{grid}};
}

Vector3 centre_of_ball(const GranularState& s, std::size_t i) { return {s.x[i], s.y[i], s.z[i]}; }
Vector3 velocity_of_ball(const GranularState& s, std::size_t i) {
  return {s.velocity_x[i], s.velocity_y[i], s.velocity_z[i]};
}
Vector3 spin_of_ball(const GranularState& s, std::size_t i) { return {s.spin_x[i], s.spin_y[i], s.spin[i]}; }
Eigen::Quaterniond turn_of_ball(const GranularState& s, std::size_t i) {
  return {s.turn_w[i], s.turn_x[i], s.turn_y[i], s.turn_z[i]};
}

StepReport advance_in_space(Simulation& simulation, Index steps) {
  StepReport last;
  for (Index k = 0; k < steps; ++k) {
    const GranularStep<3> step = solve_step<3>(simulation);
    INFO("step = ", step.report.step, ", natural map = ", step.report.residual.relative_natural_map());

    REQUIRE(step.report.status == SolverStatus::converged);
    last = take_step(simulation, step);
  }
  return last;
}

Vector3 impulse_on_second(const GranularState& state, Index a, Index b) {
  for (const RememberedImpulse& one : state.impulses)
    if (one.a == a && one.b == b) return {one.impulse[0], one.impulse[1], one.impulse[2]};
  return Vector3::Zero();
}

Simulation shaken_cube(Index n, const Dynamics& dynamics, Components<Index> grid, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<Ball> balls;
  for (Index k = 0; k < n; ++k)
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        Ball ball;
        ball.centre = {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        ball.velocity = random.normal_vector(3);
        ball.spin = 2 * random.normal_vector(3);
        balls.push_back(ball);
      }
  Dynamics shaken = dynamics;
  shaken.time.maximum_push_speed = infinity;
  return simulation_of(balls, shaken, grid);
}

}  // namespace nscdd::testing
