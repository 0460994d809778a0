// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular.hpp"

#include "linalg/random.hpp"
#include <nscdd/packing/generator.hpp>

#include <doctest/doctest.h>

namespace nscdd::testing {

Dynamics swept(const std::vector<BoundarySpec>& boundaries) {
  Dynamics dynamics;
  dynamics.boundaries = boundaries;
  dynamics.solver.algorithm = "nlgs";
  dynamics.solver.criterion = "zeta";
  dynamics.solver.tolerance = 1e-4;
  dynamics.solver.warm_start = false;
  return dynamics;
}

Dynamics tight(const std::vector<BoundarySpec>& boundaries) {
  Dynamics dynamics = swept(boundaries);
  dynamics.solver.order = "natural";
  dynamics.solver.criterion = "natural_map";
  dynamics.solver.tolerance = 1e-13;
  dynamics.solver.maximum_iterations = 200'000;
  return dynamics;
}

Dynamics without_gravity(const std::vector<BoundarySpec>& boundaries, double step) {
  Dynamics dynamics = tight(boundaries);
  dynamics.time.gravity = {0, 0};
  dynamics.time.step = step;
  return dynamics;
}

StepSolver switching(SwitchedModel model) {
  StepSolver solver = tight().solver;
  solver.algorithm = "generic";
  solver.tolerance = solver.gluing_tolerance = 1e-7;
  solver.maximum_iterations = 50'000;
  solver.model = model;
  solver.switch_after = 5;
  solver.switch_flexibility = Flexibility(1e-8, true);
  return solver;
}

BoundarySpec wall(const std::string& name, std::array<double, 2> from, std::array<double, 2> to, Motion motion) {
  return {.name = name,
          .dimension = 2,
          .from = {from[0], from[1], 0},
          .to = {to[0], to[1], 0},
          .motion = std::move(motion)};
}

BoundarySpec row_of_disks(const std::string& name, std::array<double, 2> from, std::array<double, 2> to, double radius,
                          Motion motion) {
  BoundarySpec spec = wall(name, from, to, std::move(motion));
  spec.shape = BoundaryShape::disks;
  spec.radius = radius;
  return spec;
}

BoundarySpec driven_grains(const std::string& name, Index first, Index last, Motion motion) {
  return {.name = name, .shape = BoundaryShape::grains, .first = first, .last = last, .motion = std::move(motion)};
}

FreeBody free_body(double mass, double inertia, std::array<bool, 6> directions) {
  return {.directions = directions, .mass = mass, .inertia = {0, 0, inertia}};
}

BoundarySpec clump(const std::string& name, Index first, Index last, std::array<double, 2> centre, double mass,
                   double inertia, RigidVelocity velocity) {
  BoundarySpec spec = driven_grains(name, first, last);
  spec.motion.centre = {centre[0], centre[1], 0};
  spec.motion.initial = velocity;
  spec.body = free_body(mass, inertia);
  return spec;
}

BoundarySpec plank(const std::string& name, std::array<double, 2> from, std::array<double, 2> to, double radius) {
  BoundarySpec spec = wall(name, from, to);
  spec.shape = BoundaryShape::plank;
  spec.radius = radius;
  spec.motion.centre = {(from[0] + to[0]) / 2, (from[1] + to[1]) / 2, 0};
  return spec;
}

BoundarySpec floor_wall() { return wall("floor", {0, 0}, {1, 0}); }

Motion moving(RigidVelocity velocity, std::array<double, 2> centre) {
  return {.centre = {centre[0], centre[1], 0}, .time = {0}, .velocity = {velocity}};
}

Simulation simulation_of(const std::vector<Grain>& grains, const Dynamics& dynamics, std::array<Index, 2> grid,
                         const Period& period) {
  Packing packing;
  for (const Grain& grain : grains) {
    packing.x.push_back(grain.x);
    packing.y.push_back(grain.y);
    packing.radius.push_back(grain.radius);
    packing.mass.push_back(grain.mass);
  }
  GranularScene made = scene(packing, dynamics, period);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    made.state.velocity_x[i] = grains[i].velocity_x;
    made.state.velocity_y[i] = grains[i].velocity_y;
    made.state.spin[i] = grains[i].spin;
  }
  return {made.system, made.state, dynamics, GridPartitioner{grid}};
}

std::vector<double> numbers_of(const GranularState& state) {
  std::vector<double> all;
  const auto add = [&](auto... values) { (all.push_back(static_cast<double>(values)), ...); };
  add(state.step, state.time, state.decomposed_at, state.eta);
  for (const auto values : numbers_of_grains(state.z.empty() ? 2 : 3))
    for (const double value : state.*values) add(value);
  for (const Pose& p : state.poses) add(p.x, p.y, p.z, p.angle, p.turn.w(), p.turn.x(), p.turn.y(), p.turn.z());
  for (const RigidVelocity& v : state.body_velocities) add(v.x, v.y, v.z, v.spin_x, v.spin_y, v.spin);
  for (const RememberedBond& bond : state.bonds) add(bond.a, bond.b, bond.gap);
  for (const auto& [a, b, impulse, slid] : state.impulses) add(a, b, impulse[0], impulse[1], impulse[2], slid);
  for (const auto& [grain, subdomain, impulse] : state.gluing) {
    add(grain, subdomain);
    for (const double value : impulse) add(value);
  }
  for (const RememberedModel& m : state.models)
    add(m.switched, m.standing, m.switched_iterations, m.switch_backs, m.velocity_distance, m.impulse_distance);
  return all;
}

StepReport advance(Simulation& simulation) {
  GranularStep<2> step = solve_step(simulation);
  REQUIRE(step.report.status == SolverStatus::converged);
  return take_step(simulation, std::move(step));
}

StepReport advance(Simulation& simulation, Index steps) {
  StepReport last;
  for (Index k = 0; k < steps; ++k) last = advance(simulation);
  return last;
}

std::string refusal_of(Simulation& simulation) {
  try {
    return run_simulation(simulation, {}).reason;
  } catch (const Error& error) {
    return error.what();
  }
}

LocalVector<2> impulse_between(const GranularState& state, Index a, Index b) {
  for (const RememberedImpulse& one : state.impulses)
    if (one.a == a && one.b == b) return {one.impulse[0], one.impulse[1]};
  return {};
}

Simulation box_of_grains(Index grains, const Dynamics& dynamics, std::array<Index, 2> grid, Index seed) {
  const Deposit deposit{.grains = grains,
                        .width = std::sqrt(static_cast<double>(grains)) * 0.28,
                        .sizes = {.radius_min = 0.1, .radius_max = 0.198},
                        .seed = seed};
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

double largest_speed(const std::vector<GrainVelocity<2>>& v, Index disks) {
  double largest = 0;
  for (std::size_t i = 0; i < at(disks); ++i) largest = std::max(largest, std::hypot(v[i].x, v[i].y));
  return largest;
}

Close closely(const Simulation& simulation) {
  PreparedStep<2> step = prepare_solution(simulation);
  Close result;
  for (int k = 1; k <= 60'000 && (result.gluing > 1e-10 || result.map > 1e-10); ++k) {
    step.iteration.iterate();
    result.gluing = step.iteration.record().gluing;
    if (k % 20 == 0) result.map = step.iteration.residual().relative_natural_map();
  }
  auto [contacts, velocities] = step.iteration.gather(step.share.problem);
  result.contacts = std::move(contacts);
  result.velocities = std::move(velocities);
  result.interface_size = step.iteration.parts().interface_size();
  result.grains = simulation.system.grains();
  result.problem = std::move(step.share.problem);
  return result;
}

void check_close(const Close& step, const Close& whole, double tolerance) {
  CHECK(step.gluing < 1e-9);
  CHECK(largest_difference(step.velocities, whole.velocities, step.grains) < tolerance);
}

double relative_natural_map(const std::vector<GrainContact<2>>& contacts, const std::vector<GrainVelocity<2>>& v) {
  double map = 0, impulses = 0;
  for (const GrainContact<2>& c : contacts) {
    const LocalVector<2> w = relative_velocity(c, v), r{c.impulse.n, c.impulse.t};
    const LocalVector<2> one = natural_map(r, {w.n + c.bias.n, w.t + c.bias.t}, c.friction, c.inverse_w().inverse_n);
    map += one.n * one.n + one.t * one.t;
    impulses += r.n * r.n + r.t * r.t;
  }
  return std::sqrt(map / impulses);
}

}  // namespace nscdd::testing
