// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies with contactors in space: tumbling, impacts beside the centre, planks with edges, against closed forms.
#include "../support/spheres.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

BoundarySpec body_in_space(Index first, Index last, const Vector3& centre, double mass, const Vector3& inertia,
                           RigidVelocity velocity = {},
                           const Eigen::Quaterniond& axes = Eigen::Quaterniond::Identity()) {
  BoundarySpec spec;
  spec.name = "clump";
  spec.shape = BoundaryShape::grains;
  spec.dimension = 3;
  spec.first = first;
  spec.last = last;
  spec.motion.centre = {centre[0], centre[1], centre[2]};
  spec.motion.initial = velocity;
  spec.body.emplace();
  spec.body->directions.fill(true);
  spec.body->mass = mass;
  spec.body->inertia = {inertia[0], inertia[1], inertia[2]};
  spec.body->axes = axes;
  return spec;
}

BoundarySpec board(const Vector3& middle, const Vector3& normal, const Vector3& axis, double length, double width,
                   double radius) {
  BoundarySpec spec;
  spec.name = "plank";
  spec.shape = BoundaryShape::plank;
  spec.dimension = 3;
  Vector3::Map(spec.point.data()) = middle;
  Vector3::Map(spec.normal.data()) = normal;
  Vector3::Map(spec.axis.data()) = axis;
  spec.length = length;
  spec.width = width;
  spec.radius = radius;
  spec.motion.centre = spec.point;
  return spec;
}

Dynamics weightless(const std::vector<BoundarySpec>& boundaries, double step = 1e-3) {
  Dynamics dynamics = tight(boundaries);
  dynamics.time.gravity = {0, 0, 0};
  dynamics.time.step = step;
  return dynamics;
}

Vector3 spin_of(const RigidVelocity& v) { return {v.spin_x, v.spin_y, v.spin}; }

Vector3 angular_momentum(const Simulation& simulation, std::size_t k = 0) {
  const FreeBody& body = *simulation.system.boundaries[k].body;
  const Eigen::Matrix3d axes = principal_axes(body, simulation.state.poses[k]);
  return axes * Vector3::Map(body.inertia.data()).asDiagonal() * axes.transpose() *
         spin_of(simulation.state.body_velocities[k]);
}

}  // namespace

TEST_CASE("a symmetric top turns about its angular momentum at L / I_1, which stays to rounding") {
  const Vector3 inertia(0.4, 0.4, 0.1), spin(1, 0, 5);
  const Vector3 momentum(inertia[0] * spin[0], 0, inertia[2] * spin[2]);
  double coarse = 0;
  for (const double step : {2e-3, 1e-3}) {
    const BoundarySpec top = body_in_space(0, 1, Vector3::Zero(), 2, inertia, {.spin = spin[2], .spin_x = spin[0]});
    Simulation simulation =
        simulation_of({{.centre = Vector3(0.5, 0, 0)}, {.centre = Vector3(-0.5, 0, 0)}}, weightless({top}, step));
    constexpr double time = 0.5;
    while (simulation.state.time < time - step / 2) advance_in_space(simulation);
    CHECK((angular_momentum(simulation) - momentum).norm() < 1e-12);
    // The axis of the body goes round the momentum at the rate L / I_1.
    const Vector3 axis = principal_axes(*simulation.system.boundaries[0].body, simulation.state.poses[0]).col(2);
    const Vector3 expected =
        Eigen::AngleAxisd(momentum.norm() / inertia[0] * time, momentum.normalized()) * Vector3(0, 0, 1);
    const double error = (axis - expected).norm();
    if (step == 2e-3) {
      coarse = error;
      CHECK(error < 0.02);
    } else {
      CHECK(error < 0.6 * coarse);
    }
    const GranularState& end = simulation.state;
    CHECK(centre_of_ball(end, 0).norm() == doctest::Approx(0.5).epsilon(1e-12));
    const Eigen::Quaterniond turn(end.turn_w[0], end.turn_x[0], end.turn_y[0], end.turn_z[0]);
    CHECK(end.poses[0].turn.angularDistance(turn) < 1e-7);
  }
}

TEST_CASE("a clump with axes of its own hits a plank beside its centre: the impulse of a rigid body") {
  const Eigen::Quaterniond axes(Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()));
  const Vector3 inertia(0.2, 0.5, 0.4), centre(0, 0, 0.6), lever(0.3, -0.2, -0.6), n = Vector3::UnitZ();
  constexpr double mass = 2, e = 0.7, step = 1e-7;
  const Vector3 v(0.3, -0.1, -3), w(-0.2, 0.5, 0.4);
  const Eigen::Matrix3d frame = axes.toRotationMatrix();
  const Eigen::Matrix3d inverse = frame * inertia.cwiseInverse().asDiagonal() * frame.transpose();
  Eigen::Matrix3d cross;  // lever x
  cross << 0, -lever[2], lever[1], lever[2], 0, -lever[0], -lever[1], lever[0], 0;
  const Eigen::Matrix3d delassus = Eigen::Matrix3d::Identity() / mass - cross * inverse * cross;
  const Vector3 before = v + w.cross(lever);
  for (const double friction : {0.0, 20.0}) {
    Dynamics dynamics = weightless(
        {board(Vector3(0, 0, -0.1), n, Vector3::UnitX(), 4, 4, 0.1),
         body_in_space(0, 1, centre, mass, inertia,
                       {.x = v[0], .y = v[1], .spin = w[2], .z = v[2], .spin_x = w[0], .spin_y = w[1]}, axes)},
        step);
    dynamics.interaction.friction = friction;
    dynamics.interaction.restitution = e;
    // The first sphere touches the plank with its lowest point.
    Simulation simulation = simulation_of(
        {{.centre = centre + lever + 0.3 * n, .radius = 0.3}, {.centre = Vector3(0, 0, 1), .radius = 0.2}}, dynamics);
    const StepReport report = advance_in_space(simulation);
    Vector3 impulse = n * (-(1 + e) * before.dot(n) / delassus(2, 2));
    if (friction > 0) impulse = delassus.inverse() * (Vector3(0, 0, -e * before[2]) - before);
    const RigidVelocity& after = simulation.state.body_velocities[1];
    CAPTURE(friction);
    CHECK((Vector3(after.x, after.y, after.z) - v - impulse / mass).norm() < 1e-5);
    CHECK((spin_of(after) - w - inverse * lever.cross(impulse)).norm() < 1e-5);
    CHECK(std::abs(report.energy.numerical) < 1e-5);
  }
}

TEST_CASE("a sphere meets the face, an edge and a corner of a plank along the line to its centre") {
  struct Meeting {
    Vector3 nearest, away;
  };
  for (const auto& [nearest, towards] :
       {Meeting{{0.3, 0.2, 0}, {0, 0, 1}}, Meeting{{0.3, 0.2, 0}, {0, 0, -1}}, Meeting{{1, 0.2, 0}, {1, 0, 0.8}},
        Meeting{{0.3, -0.5, 0}, {0, -0.7, -0.4}}, Meeting{{1, 0.5, 0}, {1, 0.7, 0.8}},
        Meeting{{-1, -0.5, 0}, {-0.2, -0.7, 0.1}}}) {
    const Vector3 away = towards.normalized();
    Dynamics dynamics = weightless({board(Vector3::Zero(), Vector3::UnitZ(), Vector3::UnitX(), 2, 1, 0.1)});
    dynamics.interaction.restitution = 1;
    dynamics.interaction.friction = 0;
    Simulation simulation =
        simulation_of({{.centre = nearest + (0.1 + 0.5 + 1e-4) * away, .velocity = -away}}, dynamics);
    advance_in_space(simulation, 3);
    CHECK((velocity_of_ball(simulation.state, 0) - away).norm() < 1e-11);
  }
}

TEST_CASE("clumps in space that collide keep momentum, and sweeps and the contact solver agree") {
  const auto end_of = [](Choice<StepAlgorithm> algorithm, Components<Index> grid) {
    BoundarySpec left = body_in_space(0, 1, Vector3(-1, 0, 0), 2, Vector3(0.3, 0.6, 0.5), {.x = 1, .spin = 2});
    BoundarySpec right = body_in_space(2, 3, Vector3(1, 0.3, 0.2), 3, Vector3(0.5, 0.7, 0.4), {.x = -1, .spin_x = 1});
    right.name = "other";
    Dynamics dynamics = weightless({left, right});
    dynamics.interaction.friction = 0.3;
    dynamics.solver.algorithm = algorithm;
    if (has_part(algorithm, StepPart::stage_two)) dynamics.solver.gluing_tolerance = 1e-12;
    Simulation simulation = simulation_of({{.centre = Vector3(-1.3, 0, 0.1)},
                                           {.centre = Vector3(-0.7, 0.1, 0)},
                                           {.centre = Vector3(0.8, 0.2, 0.5)},
                                           {.centre = Vector3(1.2, 0.4, -0.1)}},
                                          dynamics, grid);
    advance_in_space(simulation, 600);
    return simulation;
  };
  const Simulation swept = end_of(StepAlgorithm::nlgs, {1, 1, 1});
  const std::vector<RigidVelocity>& v = swept.state.body_velocities;
  CHECK(std::abs(v[0].x - 1) > 0.1);
  CHECK(2 * v[0].x + 3 * v[1].x == doctest::Approx(-1).epsilon(1e-11));
  CHECK(2 * v[0].y + 3 * v[1].y == doctest::Approx(0).scale(1).epsilon(1e-11));
  CHECK(2 * v[0].z + 3 * v[1].z == doctest::Approx(0).scale(1).epsilon(1e-11));
  for (const StepAlgorithm algorithm : {StepAlgorithm::automatic, StepAlgorithm::generic, StepAlgorithm::enriched}) {
    const Components<Index> grid =
        algorithm == StepAlgorithm::automatic ? Components<Index>{1, 1, 1} : Components<Index>{2, 1, 1};
    const Simulation other = end_of(algorithm, grid);
    for (std::size_t k = 0; k < 2; ++k) {
      const RigidVelocity difference = sum(other.state.body_velocities[k], -1, v[k]);
      CHECK(std::hypot(difference.x, difference.y, difference.z) < 1e-6);
      CHECK(spin_of(difference).norm() < 1e-6);
    }
  }
}
