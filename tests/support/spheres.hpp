// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "granular.hpp"

/// Scenes of spheres that move. Gravity is (0, 0, -g) unless a test says otherwise.
namespace nscdd::testing {

/// One sphere of a scene: where it is, how fast it starts.
struct Ball {
  Vector3 centre = Vector3::Zero();
  double radius = 0.5, mass = 1;
  Vector3 velocity = Vector3::Zero(), spin = Vector3::Zero();
};

/// The plane through a point, spheres where `normal` points to.
BoundarySpec plane(const std::string& name, const Vector3& point, const Vector3& normal, Motion motion = {});

/// The cylinder about the axis through two points.
BoundarySpec cylinder(const std::string& name, const Vector3& from, const Vector3& to, double radius,
                      CylinderSide side = CylinderSide::inside);

/// Uniform motion in space.
Motion moving_in_space(const Vector3& velocity, const Vector3& spin, const Vector3& centre = Vector3::Zero());

Simulation simulation_of(const std::vector<Ball>& balls, const Dynamics& dynamics, Components<Index> grid = {1, 1, 1});

Vector3 centre_of_ball(const GranularState& state, std::size_t ball);
Vector3 velocity_of_ball(const GranularState& state, std::size_t ball);
Vector3 spin_of_ball(const GranularState& state, std::size_t ball);
Eigen::Quaterniond turn_of_ball(const GranularState& state, std::size_t ball);

/// Solves and takes steps in space; requires that the solver converged.
StepReport advance_in_space(Simulation& simulation, Index steps = 1);

/// Impulse on b of a contact in the last step taken, N s, zero where there was none.
Vector3 impulse_on_second(const GranularState& state, Index a, Index b);

/// A cubic lattice of side n of touching spheres of radius 1/2 m and mass 1 kg, each with its own random velocity and
/// spin. Overlaps are pushed apart at any speed.
Simulation shaken_cube(Index n, const Dynamics& dynamics, Components<Index> grid = {1, 1, 1}, std::uint64_t seed = 1);

}  // namespace nscdd::testing
