// SPDX-License-Identifier: GPL-3.0-or-later
// Mirror symmetry, of the whole and of two strips between moving walls.
#include "../support/granular.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// The image under x -> -x: positions, walls, their motions and poses; grains start at rest.
Simulation mirrored(Simulation simulation) {
  for (double& x : simulation.state.x) x = -x;
  for (Wall& one : simulation.system.walls) {
    one.point[0] = -one.point[0];
    one.normal[0] = -one.normal[0];
  }
  for (Boundary& one : simulation.system.boundaries) {
    one.motion.centre[0] = -one.motion.centre[0];
    for (RigidVelocity& v : one.motion.velocity) v = {-v.x, v.y, -v.spin};
  }
  for (Pose& one : simulation.state.poses) one = {-one.x, one.y, -one.angle};
  return simulation;
}

// Largest difference between a state and the mirror image of another, in m, m/s and rad/s.
double distance_from_mirror(const Simulation& a, const Simulation& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.state.x.size(); ++i)
    largest = std::max({largest, std::abs(a.state.x[i] + b.state.x[i]), std::abs(a.state.y[i] - b.state.y[i]),
                        std::abs(a.state.velocity_x[i] + b.state.velocity_x[i]),
                        std::abs(a.state.velocity_y[i] - b.state.velocity_y[i]),
                        std::abs(a.state.spin[i] + b.state.spin[i])});
  return largest;
}

}  // namespace

TEST_CASE("a mirrored box moves as the mirror image, bit for bit") {
  Dynamics dynamics = swept();
  dynamics.solver.maximum_iterations = 25;
  dynamics.solver.warm_start = true;
  dynamics.solver.order = "natural";  // it is the same for the mirror image
  Simulation left = box_of_grains(80, dynamics);
  Simulation right = mirrored(left);
  for (int k = 0; k < 40; ++k) {
    take_step(left, solve_step(left));
    take_step(right, solve_step(right));
  }
  CHECK(distance_from_mirror(left, right) == 0);
  CHECK(largest_speed(solve_step(left).velocities, 80) > 1e-3);
}

TEST_CASE("a mirrored box of two strips between walls that push and turn moves as the mirror image") {
  const double width = std::sqrt(80.0) * 0.28;
  Dynamics dynamics = swept();
  dynamics.solver.algorithm = "generic";
  dynamics.solver.gauss_seidel_sweeps = 2;
  dynamics.solver.maximum_iterations = 25;
  dynamics.solver.warm_start = true;
  dynamics.solver.order = "natural";  // it is the same for the mirror image
  dynamics.boundaries = {wall("pushing left", {0, 1}, {0, 0}, moving({0.3, 0, -0.2})),
                         wall("pushing right", {width, 0}, {width, 1}, moving({-0.05, 0, 0.1}, {width, 0}))};
  Simulation left = box_of_grains(80, dynamics, {2, 1});
  Simulation right = mirrored(left);
  for (int k = 0; k < 20; ++k) {
    take_step(left, solve_step(left));
    REQUIRE(take_step(right, solve_step(right)).interface_size > 0);
  }
  // Not bit for bit: the copies of a shared grain are added up in the order of the strips.
  CHECK(distance_from_mirror(left, right) < 1e-11);
  CHECK(right.state.poses[0].x == -left.state.poses[0].x);
  CHECK(largest_speed(solve_step(left).velocities, 80) > 1e-1);
}
