// SPDX-License-Identifier: GPL-3.0-or-later
// How a step ends: every status. A result with infinite or undefined entries never passes for converged.
#include "../support/granular.hpp"
#include "simulation/simulation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("status: converged, maximum reached, and as many iterations as asked for without a criterion") {
  Dynamics dynamics = swept();
  dynamics.solver.tolerance = 1e-6;
  Simulation s = shaken_lattice(5, 5, dynamics);
  const GranularStep<2> converged = solve_step(s);
  CHECK(converged.report.status == SolverStatus::converged);
  CHECK(converged.report.last.zeta <= 1e-6);
  s.dynamics.solver.maximum_iterations = 3;
  CHECK(solve_step(s).report.status == SolverStatus::maximum_reached);
  CHECK(solve_step(s).report.last.iteration == 3);
  s.dynamics.solver.maximum_iterations = 77;
  s.dynamics.solver.criterion = "none";
  const GranularStep<2> none = solve_step(s);
  CHECK(none.report.status == SolverStatus::maximum_reached);
  CHECK(none.report.last.iteration == 77);
}

TEST_CASE("status: stalled when rounding keeps a criterion from falling for 10 000 iterations") {
  Dynamics dynamics = swept();
  dynamics.solver.criterion = "natural_map";
  dynamics.solver.tolerance = 1e-30;
  dynamics.solver.maximum_iterations = 100'000;
  const GranularStep<2> step = solve_step(shaken_lattice(4, 4, dynamics));
  CHECK(step.report.status == SolverStatus::stalled);
  CHECK(step.report.last.iteration < 20'000);
  CHECK(step.report.residual.relative_natural_map() < 1e-13);
}

TEST_CASE("status: an iteration that took long to make progress is waited for four times as long") {
  StepSolver solver = swept().solver;
  solver.tolerance = 0;
  solver.maximum_iterations = 1'000'000;
  for (const Index progress : {100, 5000}) {
    CAPTURE(progress);
    IterationWatch watch(solver);
    Index iteration = 0;
    std::optional<SolverStatus> status;
    while (!status) {
      ++iteration;
      const double zeta = 1 / static_cast<double>(std::min(iteration, progress));
      status = watch.judge({.iteration = iteration, .zeta = zeta, .impulses = 1}, {});
    }
    CHECK(*status == SolverStatus::stalled);
    CHECK(iteration == progress + std::max<Index>(10'000, 4 * progress));
  }
}

TEST_CASE("status: diverged as soon as impulses are a million times those of the first iterations") {
  IterationWatch watch(swept().solver);
  for (Index k = 1; k <= 20; ++k) CHECK_FALSE(watch.judge({.iteration = k, .zeta = 1, .impulses = 4}, {}));
  CHECK_FALSE(watch.judge({.iteration = 21, .zeta = 1, .impulses = 3.9e12}, {}));  // squares
  CHECK(watch.judge({.iteration = 22, .zeta = 1, .impulses = 4.1e12}, {}) == SolverStatus::diverged);
}

TEST_CASE("status: an indicator that is not a number, or impulses or jumps that are not finite, end a step at once") {
  for (const IterationRecord& record : {IterationRecord{.iteration = 1, .zeta = not_a_number, .impulses = 1},
                                        IterationRecord{.iteration = 1, .zeta = 1, .impulses = infinity},
                                        IterationRecord{.iteration = 1, .zeta = 1, .gluing = infinity, .impulses = 1}})
    CHECK(IterationWatch(swept().solver).judge(record, {}) == SolverStatus::no_number);
}

TEST_CASE("status: diverged under an enrichment that is far too stiff, and the state is as it was") {
  Dynamics dynamics = swept();
  dynamics.interaction.friction = 0.3;
  dynamics.solver.algorithm = "enriched";
  dynamics.solver.eta = "1e-9";
  dynamics.solver.gauss_seidel_sweeps = 1;
  dynamics.solver.maximum_iterations = 100'000;
  const Simulation s = shaken_lattice(6, 6, dynamics, {2, 2});
  const GranularStep<2> step = solve_step(s);
  CHECK(step.report.status == SolverStatus::diverged);
  CHECK(s.state.step == 0);
  CHECK(describe_breakdown(s, step).find("largest impulse") != std::string::npos);
}

TEST_CASE("criterion interface_change without an interface does not pass the first sweep for converged") {
  for (const std::string algorithm : {"nlgs", "generic"}) {
    CAPTURE(algorithm);
    Dynamics dynamics = swept();
    dynamics.solver.algorithm = algorithm;
    dynamics.solver.criterion = "interface_change";
    dynamics.solver.tolerance = 1e-8;
    const GranularStep<2> step = solve_step(shaken_lattice(6, 6, dynamics));
    CHECK(step.report.status == SolverStatus::converged);
    CHECK(step.report.residual.relative_natural_map() < 1e-5);
  }
}

TEST_CASE("criterion interface_change of the semi-implicit scheme waits for the impulses") {
  Dynamics dynamics = swept();
  dynamics.solver.algorithm = "enriched";
  dynamics.solver.enrichment = "semi_implicit";
  dynamics.solver.criterion = "interface_change";
  dynamics.solver.tolerance = 1e-8;
  const GranularStep<2> step = solve_step(shaken_lattice(6, 6, dynamics, {2, 1}));
  CHECK(step.report.last.zeta < 1e-6);
}

TEST_CASE("no number: velocities or interface impulses that are none are never called converged") {
  // 1 / mass overflows: V_free + M^-1 H r is infinite or undefined after the first sweep.
  for (const std::string law : {"coulomb", "frictionless", "cohesive", "linear_viscous"})
    for (const std::string criterion : {"zeta", "natural_map", "quad_dv", "qm_16", "normal_change", "interface_change"})
      for (const std::string algorithm : {"nlgs", "generic"}) {
        INFO("law = ", law, ", criterion = ", criterion, ", algorithm = ", algorithm);
        Dynamics dynamics = swept();
        dynamics.interaction.law = law;
        dynamics.interaction.cohesion = 1;
        dynamics.interaction.epsilon = 0.1;
        dynamics.solver.criterion = criterion;
        dynamics.solver.algorithm = algorithm;
        Simulation s = shaken_lattice(4, 4, dynamics, {2, 1});
        s.system.mass[5] = 1e-310;
        const GranularStep<2> step = solve_step(s);
        bool finite = true;
        for (Index i = 0; i < s.system.grains(); ++i)
          finite = finite && std::isfinite(step.velocities[at(i)].x + step.velocities[at(i)].rim);
        CHECK((finite || step.report.status == SolverStatus::no_number));
      }
}

TEST_CASE("describe_breakdown names what is not finite") {
  Dynamics dynamics = swept();
  Simulation s = shaken_lattice(3, 2, dynamics);
  GranularStep<2> step = solve_step(s);
  GranularStep<2> broken = step;
  broken.contacts[2].impulse.t = not_a_number;
  const StepContact& c = step.problem.geometry[2];
  CHECK(describe_breakdown(s, broken).starts_with("contact of disk " + std::to_string(c.a) + " and disk " +
                                                  std::to_string(c.b) + " at ("));
  CHECK(describe_breakdown(s, broken).ends_with(") m: the impulse is not finite"));
  broken = step;
  broken.all_grains[4][5] = infinity;
  s.state.x[4] = 1.5;
  s.state.y[4] = -2;
  CHECK(describe_breakdown(s, broken) == "disk 4 at (1.5, -2) m: the velocity is not finite");
  s.system.boundaries.push_back({.name = "drum", .motion = {}});
  s.system.driven_by[4] = 0;
  CHECK(describe_breakdown(s, broken).starts_with("disk 4 of boundary 'drum' at ("));
  GranularStep<2> empty;
  CHECK(describe_breakdown(s, empty) == "no contact");
}

TEST_CASE("a case that asks for an eta that is not a number is refused") {
  Dynamics dynamics;
  for (const std::string eta : {"fast", "0", "-1", "nan", "", "W", "0 W", "1 w", "optimal W"}) {
    CAPTURE(eta);
    CHECK_THROWS_WITH_AS(dynamics.solver.eta = eta, doctest::Contains("eta: expected"), Error);
  }
}

TEST_CASE("an impact that meets the interface through grains at rest is solved like any other") {
  Dynamics dynamics = without_gravity({}, 0.005);
  dynamics.solver.algorithm = "generic";
  std::vector<Grain> grains{{.x = -1, .velocity_x = 6}};
  for (int k = 0; k < 5; ++k) grains.push_back({.x = static_cast<double>(k)});
  Simulation s = simulation_of(grains, dynamics, {2, 1});
  s.state.x[0] -= 0.5 * dynamics.time.step * 6;  // touches at q_m
  const GranularStep<2> step = solve_step(s);
  REQUIRE(step.report.interface_size > 0);
  CHECK(step.report.status == SolverStatus::converged);
  CHECK(std::isfinite(step.report.last.gluing));
  for (Index i = 0; i < 6; ++i) CHECK(step.velocities[at(i)].x == doctest::Approx(1.0).epsilon(1e-9));
}

TEST_CASE("disks that touch and move alike exchange nothing: the step ends at once") {
  Dynamics dynamics = swept();
  dynamics.time.gravity = {0, 0};
  std::vector<Grain> grains;
  for (int k = 0; k < 6; ++k) grains.push_back({.x = 0.1 + k, .velocity_x = 1});
  for (const std::string criterion : {"zeta", "natural_map"}) {
    dynamics.solver.criterion = criterion;
    const GranularStep<2> step = solve_step(simulation_of(grains, dynamics));
    CHECK(step.report.status == SolverStatus::converged);
    CHECK(step.report.last.iteration < 50);
  }
}

TEST_CASE("contacts that have settled within subdomains are not converged while the interface is open") {
  Dynamics dynamics = swept();
  dynamics.solver.algorithm = "generic";
  dynamics.solver.interface_relaxation = 1e-4;  // Stage 2 hardly closes the interface
  dynamics.solver.tolerance = 1e-4;
  dynamics.solver.maximum_iterations = 3000;
  Simulation simulation = box_of_grains(60, dynamics, {2, 1});
  const GranularStep<2> open = solve_step(simulation);
  CHECK(open.report.last.gluing > 0.01);
  CHECK(open.report.status == SolverStatus::maximum_reached);
  simulation.dynamics.solver.gluing_tolerance = 10;
  CHECK(solve_step(simulation).report.status == SolverStatus::converged);
}
