// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular.hpp"

#include "linalg/random.hpp"
#include <nscdd/packing/generator.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace nscdd::testing {

Dynamics swept() {
  Dynamics dynamics;
  dynamics.solver.algorithm = "nlgs";
  dynamics.solver.criterion = "zeta";
  dynamics.solver.tolerance = 1e-4;
  dynamics.solver.warm_start = false;
  return dynamics;
}

Dynamics tight() {
  Dynamics dynamics = swept();
  dynamics.solver.order = "natural";
  dynamics.solver.criterion = "natural_map";
  dynamics.solver.tolerance = 1e-13;
  dynamics.solver.maximum_iterations = 200'000;
  return dynamics;
}

BoundarySpec wall(const std::string& name, std::array<double, 2> from, std::array<double, 2> to, Motion motion) {
  BoundarySpec spec;
  spec.name = name;
  spec.dimension = 2;
  spec.from = {from[0], from[1], 0};
  spec.to = {to[0], to[1], 0};
  spec.motion = std::move(motion);
  return spec;
}

BoundarySpec row_of_disks(const std::string& name, std::array<double, 2> from, std::array<double, 2> to, double radius,
                          Motion motion) {
  BoundarySpec spec = wall(name, from, to, std::move(motion));
  spec.shape = BoundaryShape::disks;
  spec.radius = radius;
  return spec;
}

BoundarySpec driven_grains(const std::string& name, Index first, Index last, Motion motion) {
  BoundarySpec spec;
  spec.name = name;
  spec.shape = BoundaryShape::grains;
  spec.first = first;
  spec.last = last;
  spec.motion = std::move(motion);
  return spec;
}

BoundarySpec floor_wall() { return wall("floor", {0, 0}, {1, 0}); }

Motion moving(RigidVelocity velocity, std::array<double, 2> centre) {
  return {.centre = {centre[0], centre[1], 0}, .time = {0}, .velocity = {velocity}};
}

Simulation simulation_of(const std::vector<Grain>& grains, const Dynamics& dynamics, std::array<Index, 2> grid) {
  Packing packing;
  for (const Grain& grain : grains) {
    packing.x.push_back(grain.x);
    packing.y.push_back(grain.y);
    packing.radius.push_back(grain.radius);
    packing.mass.push_back(grain.mass);
  }
  GranularScene made = scene(packing, dynamics);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    made.state.velocity_x[i] = grains[i].velocity_x;
    made.state.velocity_y[i] = grains[i].velocity_y;
    made.state.spin[i] = grains[i].spin;
  }
  return {made.system, made.state, dynamics, GridPartitioner{grid}};
}

StepReport advance(Simulation& simulation) {
  SolvedStep<2> step = solve_step(simulation);
  REQUIRE(step.report.status == SolverStatus::converged);
  return take_step(simulation, std::move(step));
}

StepReport advance(Simulation& simulation, Index steps) {
  StepReport last;
  for (Index k = 0; k < steps; ++k) last = advance(simulation);
  return last;
}

LocalVector<2> impulse_between(const GranularState& state, Index a, Index b) {
  for (const RememberedImpulse& one : state.impulses)
    if (one.a == a && one.b == b) return {one.impulse[0], one.impulse[1]};
  return {};
}

Simulation box_of_grains(Index grains, const Dynamics& dynamics, std::array<Index, 2> grid, Index seed) {
  Deposit deposit;
  deposit.grains = grains;
  deposit.width = std::sqrt(static_cast<double>(grains)) * 0.28;
  deposit.sizes.radius_min = 0.1;
  deposit.sizes.radius_max = 0.198;
  deposit.seed = seed;
  const Packing packing = with_masses(generate(Generator{deposit}), {.model = MassModel::density, .density = 2500});
  Dynamics own = dynamics;
  own.boundaries.push_back(floor_wall());
  own.boundaries.push_back(wall("left", {0, 1}, {0, 0}));
  own.boundaries.push_back(wall("right", {deposit.width, 0}, {deposit.width, 1}));
  GranularScene made = scene(packing, own);
  return {made.system, made.state, own, GridPartitioner{grid}};
}

Simulation shaken_lattice(Index columns, Index rows, const Dynamics& dynamics, std::array<Index, 2> grid,
                          std::uint64_t seed) {
  Packing packing = generate(Generator{HexagonalLattice{.columns = columns, .rows = rows, .radius = 0.5}});
  packing.mass.assign(packing.x.size(), 1.0);
  Dynamics own = dynamics;
  own.time.maximum_push_speed = infinity;  // half a step on, touching disks overlap by as much as they part
  GranularScene made = scene(packing, own);
  RandomStream random(seed);
  for (std::size_t i = 0; i < packing.x.size(); ++i) {
    made.state.velocity_x[i] = 2 * random.uniform() - 1;
    made.state.velocity_y[i] = 2 * random.uniform() - 1;
    made.state.spin[i] = 2 * random.uniform() - 1;
  }
  return {made.system, made.state, own, GridPartitioner{grid}};
}

double largest_difference(const std::vector<GrainVelocity<2>>& a, const std::vector<GrainVelocity<2>>& b, Index disks) {
  double largest = 0;
  for (std::size_t i = 0; i < at(disks); ++i)
    largest = std::max({largest, std::abs(a[i].x - b[i].x), std::abs(a[i].y - b[i].y), std::abs(a[i].rim - b[i].rim)});
  return largest;
}

double largest_speed(const std::vector<GrainVelocity<2>>& v, Index disks) {
  double largest = 0;
  for (std::size_t i = 0; i < at(disks); ++i) largest = std::max(largest, std::hypot(v[i].x, v[i].y));
  return largest;
}

}  // namespace nscdd::testing
