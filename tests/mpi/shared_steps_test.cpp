// SPDX-License-Identifier: GPL-3.0-or-later
// What each process has of a step that several share.
#include "../support/spheres.hpp"
#include "ranks.hpp"
#include "simulation/simulation.hpp"
#include <nscdd/mpi/bddc.hpp>
#include <nscdd/packing/generator.hpp>

#include <doctest/doctest.h>

#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Dynamics dynamics_of(const std::string& algorithm) {
  Dynamics dynamics = tight();
  dynamics.solver.algorithm = algorithm;
  dynamics.solver.tolerance = algorithm == "generic" || algorithm == "schwarz" ? dynamics.solver.tolerance : 1e-9;
  dynamics.solver.interface_preconditioner = "X";  // the bits of one process
  dynamics.solver.redecompose = 3;
  return dynamics;
}

Simulation shaken(const std::string& algorithm) { return shaken_lattice(9, 6, dynamics_of(algorithm), {4, 2}); }

// Grains that stick together and are thrown back, on a row of driven disks that moves through all subdomains.
Simulation cohesive(const std::string& algorithm) {
  Dynamics dynamics = dynamics_of(algorithm);
  dynamics.interaction.law = "cohesive";
  dynamics.interaction.cohesion = 20;
  dynamics.interaction.restitution = dynamics.interaction.tangential_restitution = 0.4;
  dynamics.solver.contact_relaxation = algorithm == "two_stage_admm" ? 1 : 0.8;
  dynamics.solver.warm_start = true;
  BoundarySpec row = wall("row", {-1, -1}, {10, -1}, moving({0.3, 0, 0}));
  row.shape = BoundaryShape::disks;
  row.radius = 0.4;
  dynamics.boundaries = {row, wall("left", {-0.5, 6}, {-0.5, 0})};
  return shaken_lattice(9, 6, dynamics, {4, 2});
}

// Rows of the lattice are clumps, each in several subdomains, over a wall that a force pushes up.
Simulation clumped(const std::string& algorithm) {
  Dynamics dynamics = dynamics_of(algorithm);
  dynamics.interaction.friction = 0.3;
  dynamics.solver.warm_start = true;
  dynamics.solver.maximum_iterations = 60;                                  // bits are equal on the way, too
  if (algorithm == "schwarz") dynamics.solver.interface_relaxation = 0.25;  // a clump is in up to eight subdomains
  const Packing lattice = generate(Generator{HexagonalLattice{.columns = 9, .rows = 6, .radius = 0.5}});
  double foot = infinity;
  for (const double y : lattice.y) foot = std::min(foot, y - 0.5);
  for (const auto& [first, last] : {std::array<Index, 2>{10, 12}, {22, 25}, {40, 41}}) {
    double middle = 0;
    for (Index i = first; i <= last; ++i) middle += lattice.x[at(i)] / static_cast<double>(last - first + 1);
    dynamics.boundaries.push_back(clump("clump " + std::to_string(first), first, last, {middle, lattice.y[at(first)]},
                                        3, 2, {.x = 0.3, .y = -0.5, .spin = 0.2}));
  }
  BoundarySpec floor = wall("floor", {0, foot}, {1, foot});
  floor.body = free_body(5, 0, {false, true});
  floor.body->load = moving({.y = 900});
  dynamics.boundaries.push_back(floor);
  return shaken_lattice(9, 6, dynamics, {4, 2});
}

// Two beds in opposite corners, with subdomains between them that no contact is in.
Simulation apart(const std::string& algorithm) {
  std::vector<Grain> grains;
  for (int k = 0; k < 12; ++k)
    for (const double corner : {0.0, 60.0})
      grains.push_back({.x = corner + k % 4, .y = corner + k / 4, .velocity_y = k % 2 - 0.5});
  return simulation_of(grains, dynamics_of(algorithm), {4, 2});
}

// No contact at all.
Simulation free_fall(const std::string& algorithm) {
  return simulation_of({{.x = 0}, {.x = 5}, {.x = 9}}, dynamics_of(algorithm), {4, 2});
}

// Steps of one process and of several, bit for bit.
template <int D = 2>
void check_run(const Simulation& start, int steps) {
  Simulation alone = start, shared = start;
  shared.processes = world();
  for (int step = 0; step < steps; ++step) {
    CAPTURE(step);
    const GranularStep<D> whole = solve_step<D>(alone), own = solve_step<D>(shared);
    CHECK(world().sum(static_cast<double>(own.contacts.size())) == static_cast<double>(whole.contacts.size()));
    std::size_t k = 0;  // both lists ascend
    for (std::size_t c = 0; c < own.contacts.size(); ++c) {
      const StepContact& here = own.problem.geometry[c];
      while (k < whole.contacts.size() &&
             (whole.problem.geometry[k].a != here.a || whole.problem.geometry[k].b != here.b))
        ++k;
      REQUIRE(k < whole.contacts.size());
      CHECK(whole.contacts[k].impulse.n == own.contacts[c].impulse.n);
      CHECK(squared(whole.contacts[k].impulse - own.contacts[c].impulse) == 0);
      CHECK(whole.partition.subdomain_of_contact[k] == own.partition.subdomain_of_contact[c]);
    }
    CHECK(own.all_grains == whole.all_grains);
    CHECK(own.problem.scale == whole.problem.scale);
    CHECK(own.report.contacts == whole.report.contacts);
    CHECK(own.report.overlap.mean == whole.report.overlap.mean);
    CHECK(own.report.last.sweeps == whole.report.last.sweeps);
    CHECK(own.report.factorisations == whole.report.factorisations);
    CHECK(own.report.residual.natural_map == whole.report.residual.natural_map);
    CHECK(own.report.residual.qm_16() == whole.report.residual.qm_16());
    const StepReport expected = take_step(alone, whole), met = take_step(shared, own);
    CHECK(met.energy.dissipation == expected.energy.dissipation);
    CHECK(met.energy.kinetic == expected.energy.kinetic);
    CHECK(shared.state.x == alone.state.x);
    REQUIRE(shared.state.body_velocities.size() == alone.state.body_velocities.size());
    for (std::size_t b = 0; b < alone.state.body_velocities.size(); ++b) {
      const RigidVelocity &v = shared.state.body_velocities[b], &w = alone.state.body_velocities[b];
      CHECK(std::array{v.x, v.y, v.z, v.spin_x, v.spin_y, v.spin} ==
            std::array{w.x, w.y, w.z, w.spin_x, w.spin_y, w.spin});
    }
    // Of every contact of its grains a process remembers the subdomain, and of its own contacts the impulse.
    for (const RememberedSubdomain& one : alone.state.subdomains) {
      const auto has = [&](Index grain) {
        return grain < alone.system.grains() && alone.system.free(grain) && body_of(own.problem, grain) >= 0;
      };
      const auto found = std::ranges::find_if(shared.state.subdomains, [&](const RememberedSubdomain& known) {
        return known.a == one.a && known.b == one.b && known.subdomain == one.subdomain;
      });
      if (has(one.a) || has(one.b)) CHECK(found != shared.state.subdomains.end());
    }
    CHECK(world().sum(static_cast<double>(shared.state.impulses.size())) ==
          static_cast<double>(alone.state.impulses.size()));
  }
}

}  // namespace

TEST_CASE("shared steps: every contact is in one process, which knows all contacts of its grains") {
  for (const std::string algorithm : {"generic", "schwarz", "two_stage_newton", "two_stage_admm"}) {
    CAPTURE(algorithm);
    // Others exchange more messages, and more ranks than cores wait longer for them.
    const bool generic = algorithm == "generic" || algorithm == "schwarz", longer = generic && world().size <= 2;
    check_run(shaken(algorithm), longer ? 5 : 2);
    check_run(cohesive(algorithm), longer ? 4 : generic ? 2 : 1);
    check_run<3>(shaken_cube(generic ? 3 : 2, dynamics_of(algorithm), {2, 2, 2}), 1);
  }
}

TEST_CASE("shared steps: clumps and a pushed wall in several processes move as in one, bit for bit") {
  if (world().size > 2) return;  // more ranks than cores exchange messages for minutes
  for (const std::string algorithm : {"generic", "schwarz"}) {
    const Simulation start = clumped(algorithm);
    REQUIRE(start.system.free_bodies.size() == 4);
    check_run(start, 4);
  }
}

TEST_CASE("shared steps: criteria that are sums and maxima over all contacts have the bits of one process") {
  for (const std::string criterion : {"qm_16", "normal_change"}) {
    CAPTURE(criterion);
    Simulation alone = shaken("generic");
    alone.dynamics.solver.criterion = criterion;
    alone.dynamics.solver.tolerance = 1e-3;
    Simulation shared = alone;
    shared.processes = world();
    const StepReport whole = solve_step(alone).report, own = solve_step(shared).report;
    CHECK(whole.status == SolverStatus::converged);
    CHECK(own.last.iteration == whole.last.iteration);
    CHECK(own.residual.qm_16() == whole.residual.qm_16());
    if (criterion == "normal_change") CHECK(own.last.normal_change == whole.last.normal_change);
  }
}

TEST_CASE("shared steps: two-stage ADMM with BDDC has the solutions of one process") {
  if (world().size > 2) return;  // ranks of PETSc that take turns on a core wait for each other
  const std::array<Index, 2> grid{world().size, 1};
  for (const std::string space : {"none", "geneo"}) {
    CAPTURE(space);
    Dynamics dynamics = dynamics_of("two_stage_admm");
    Simulation alone = shaken_lattice(9, 6, dynamics, grid);
    dynamics.solver.interface_preconditioner = "bddc";
    dynamics.solver.coarse_space = space;
    Simulation shared = shaken_lattice(9, 6, dynamics, grid);
    shared.processes = world();
    shared.bddc = mpi::bddc(MPI_COMM_WORLD);
    for (int step = 0; step < 2; ++step) {
      const GranularStep<2> whole = solve_step(alone), own = solve_step(shared);
      CHECK(own.report.status == SolverStatus::converged);
      CHECK(own.report.interface_systems == whole.report.interface_systems);
      CHECK(own.report.factorisations == whole.report.factorisations);
      take_step(alone, whole);
      take_step(shared, own);
      for (std::size_t i = 0; i < alone.state.x.size(); ++i)
        CHECK(shared.state.velocity_x[i] == doctest::Approx(alone.state.velocity_x[i]).epsilon(1e-6));
    }
  }
  Dynamics newton = dynamics_of("two_stage_newton");
  newton.solver.interface_preconditioner = "bddc";
  CHECK_THROWS_WITH_AS(solve_step(shaken_lattice(9, 6, newton, grid)),
                       doctest::Contains("expected another one with two_stage_newton"), Error);
  newton.solver.algorithm = "two_stage_admm";
  CHECK_THROWS_WITH_AS(solve_step(shaken_lattice(9, 6, newton, grid)), doctest::Contains("which nscdd-mpi has"), Error);
}

TEST_CASE("shared steps: processes without contacts, and steps without any") {
  for (const std::string algorithm : {"generic", "schwarz", "two_stage_newton", "two_stage_admm"}) {
    CAPTURE(algorithm);
    const GranularStep<2> bed = solve_step(apart(algorithm));
    const auto& used = bed.partition.subdomain_of_contact;
    CHECK(std::set<Index>(used.begin(), used.end()).size() < 5);
    check_run(apart(algorithm), algorithm == "generic" ? 3 : 1);
    check_run(free_fall(algorithm), 1);
    if (algorithm == "generic" || algorithm == "schwarz") continue;
    // With a network in Stage 2 the shared factor takes processes without unknowns.
    Simulation active = apart(algorithm);
    active.dynamics.solver.interface_preconditioner = "X_eta_active";
    active.processes = world();
    CHECK(solve_step(active).report.status == SolverStatus::converged);
  }
}

TEST_CASE("shared steps: processes that find other contacts all say so, and none waits") {
  if (world().alone()) return;
  for (const Index odd : {Index{0}, world().size - 1}) {
    Simulation one = shaken("generic");
    one.processes = world();
    if (world().rank == odd) one.dynamics.time.alert *= 40;
    CHECK_THROWS_WITH_AS(
        world().together([&] { return share_step<2>(one); }),
        "processes: expected the same step on all ranks, met different ones: their processors may differ", Error);
  }
}

TEST_CASE("shared steps: all processes end at a step without a solution, with the same chain") {
  Dynamics dynamics = dynamics_of("generic");
  dynamics.solver.maximum_iterations = 300;
  dynamics.solver.verdict = "every";
  dynamics.time.steps = 2;
  dynamics.boundaries = {wall("left", {-0.5, 5}, {-0.5, -5}),
                         wall("right", {7.5, -5}, {7.5, 5}, moving({.x = -0.1}, {7.5, 0}))};
  std::vector<Grain> row(8);
  for (int k = 0; k < 8; ++k) row[at(k)].x = k;
  Simulation alone = simulation_of(row, dynamics, {8, 1}), shared = alone;
  shared.processes = world();
  const RunOutcome whole = run_simulation(alone, {}), own = run_simulation(shared, {});
  CHECK(whole.end == RunEnd::impossible);
  CHECK(own.end == RunEnd::impossible);
  CHECK(own.reason == whole.reason);
  CHECK(whole.chain.size() == 9);
  REQUIRE(own.chain.size() == whole.chain.size());
  for (std::size_t k = 0; k < own.chain.size(); ++k) CHECK(own.chain[k].stress == whole.chain[k].stress);
  CHECK(shared.state.step == 0);
}
