// SPDX-License-Identifier: GPL-3.0-or-later
// At frozen statuses the algorithm with friction is the linear map that FrozenIteration and frozen_contraction say it
// is: against the spectral code where nothing slides, against the run itself where contacts do.
#include "../support/granular.hpp"
#include "simulation/step_decomposition.hpp"
#include "study/moving/compared_rates.hpp"
#include "two_stage/frozen_iteration.hpp"
#include <nscdd/ddm/contraction.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Column by column.
Matrix dense(const Contraction& b) {
  Matrix a(b.rows(), b.cols());
  for (Index j = 0; j < b.cols(); ++j) a.col(j) = b.apply(Vector::Unit(b.cols(), j));
  return a;
}

Simulation sheared_box(Index grains, std::array<Index, 2> grid, const std::string& law = "coulomb") {
  Dynamics dynamics = tight();
  dynamics.solver.algorithm = "generic";
  dynamics.interaction.law = law;
  dynamics.interaction.friction = 0.3;
  Simulation simulation = box_of_grains(grains, dynamics, grid);
  for (std::size_t i = 0; i < simulation.state.x.size(); ++i)
    simulation.state.velocity_x[i] = 0.02 * simulation.state.y[i];
  return simulation;
}

// A box whose side walls turn about their feet, both the same way, 20 steps on.
Simulation box_with_turning_walls(Index grains, Index seed) {
  const double width = std::sqrt(static_cast<double>(grains)) * 0.28, spin = -0.075;
  Dynamics dynamics = swept();
  dynamics.solver.order = "natural";
  dynamics.time.maximum_push_speed = infinity;
  dynamics.solver.maximum_iterations = 300;
  dynamics.solver.warm_start = true;
  dynamics.boundaries = {wall("turning left", {0, 1}, {0, 0}, moving({0, 0, spin})),
                         wall("turning right", {width, 0}, {width, 1}, moving({0, 0, spin}, {width, 0}))};
  Simulation simulation = box_of_grains(grains, dynamics, {2, 1}, seed);
  for (int k = 0; k < 20; ++k) take_step(simulation, solve_step(simulation));
  return simulation;
}

}  // namespace

TEST_CASE("frozen contraction: all contacts stick, it is the rigid contraction of the spectral code") {
  // A lattice: its dependent contacts are so to rounding, and no decision on ranks is a close one.
  Dynamics dynamics = tight();
  dynamics.solver.algorithm = "generic";
  const Simulation simulation = shaken_lattice(6, 5, dynamics, {2, 2});
  const StepProblem<2> problem = prepare_step<2>(start_of(simulation), false);
  const Partition partition = partition_step(simulation, problem.geometry);
  const GranularDecomposition<2> parts = decompose(problem, partition, "natural", 1);
  const Decomposition linear =
      decompose(reference_problem(problem, simulation.system.grains()), partition_of_columns(partition, 2));
  const std::vector<ContactStatus> sticking(problem.contacts.size(), ContactStatus::stick);
  REQUIRE(parts.interface_size() > 20);
  const std::vector<FrozenContact<2>> stick = frozen_contacts(parts, sticking);
  const Matrix generic = dense(contraction(linear, Generic{}, LinearViscous{.epsilon = 0}));
  CHECK((frozen_contraction(parts, stick, {}) - generic).norm() < 1e-9 * generic.norm());
  const Matrix enriched = dense(contraction(linear, Enriched{.eta = 0.5}, LinearViscous{.epsilon = 0}));
  CHECK((frozen_contraction(parts, stick, InterfaceFamily(linear).at(0.5)) - enriched).norm() < 1e-8 * enriched.norm());
  for (const double omega : {0.4, 1.7}) {
    Contraction b = contraction(linear, Generic{}, LinearViscous{.epsilon = 0});
    b.relaxation = omega;
    const Matrix relaxed = dense(b);
    CHECK((frozen_contraction(parts, stick, {}, omega) - relaxed).norm() < 1e-9 * relaxed.norm());
  }
}

TEST_CASE("frozen iteration: many sweeps are an exact Stage 1, with sliding contacts and whole copies too") {
  // Contacts of a deposit that touch are as many as it needs: no network is close to a dependent one.
  const Simulation simulation = sheared_box(30, {2, 1});
  const StepProblem<2> problem = prepare_step<2>(start_of(simulation), false);
  const Partition partition = partition_step(simulation, problem.geometry);
  struct Iterated {
    CopyMass copies;
    double omega;
  };
  for (const Iterated& one : {Iterated{CopyMass::shares, 1}, {CopyMass::whole, 1}, {CopyMass::whole, 0.45}})
    for (const auto& sliding : {std::vector<ContactStatus>{ContactStatus::slide_forward},
                                {ContactStatus::slide_forward, ContactStatus::slide_backward},
                                {ContactStatus::slide_backward, ContactStatus::slide_backward,
                                 ContactStatus::slide_forward, ContactStatus::open}}) {
      INFO("whole copies: ", one.copies == CopyMass::whole, ", omega = ", one.omega);
      const auto parts = decompose(problem, partition, "natural", 1, {}, {}, one.copies);
      std::vector<ContactStatus> statuses;
      for (std::size_t k = 0; k < problem.contacts.size(); ++k) statuses.push_back(sliding[k % sliding.size()]);
      const std::vector<FrozenContact<2>> frozen = frozen_contacts(parts, statuses);
      const double exact = frozen_radius(frozen_contraction(parts, frozen, {}, one.omega)).value;
      const double many = frozen_radius(FrozenIteration(parts, frozen, 5000, {}, one.omega)).value;
      CHECK(many == doctest::Approx(exact).epsilon(1e-6));
      const FrozenIteration few(parts, frozen, 3, {}, one.omega);
      const Vector y = few.project(Vector::LinSpaced(few.rows(), -1, 1));
      CHECK((few.apply(y, 2) - few.apply(few.apply(y))).norm() < 1e-12 * y.norm());
      CHECK(frozen_radius(few, 5).value == doctest::Approx(frozen_radius(few).value).epsilon(1e-9));
    }
}

TEST_CASE("frozen iteration: with sliding contacts, changes of the velocities of the run follow it") {
  for (const Index sweeps : {1, 3}) {
    Simulation simulation = sheared_box(60, {2, 1});
    simulation.dynamics.solver.gauss_seidel_sweeps = sweeps;
    PreparedStep<2> step = prepare_solution(simulation);
    const GranularDecomposition<2> parts = step.iteration.parts();
    int compared = 0, sliding = 0;
    std::vector<std::vector<ContactStatus>> statuses;
    std::vector<Vector> y;
    for (int k = 0; k < 4000 && compared < 5; ++k) {
      step.iteration.iterate();
      statuses.push_back(step.iteration.statuses());
      y.push_back(step.iteration.parts().free_velocities());
      const std::size_t last = y.size() - 1;
      if (last < 200 || last % 50 != 0) continue;
      bool kept = true;  // over some iterations, so that no sweep met another status in between
      for (std::size_t i = last - 4; i < last; ++i) kept = kept && statuses[i] == statuses[last];
      const Vector before = y[last - 1] - y[last - 2], after = y[last] - y[last - 1];
      if (!kept || before.norm() < 1e-9 * y[last].norm()) continue;
      const FrozenIteration frozen(parts, frozen_contacts(parts, statuses[last]), sweeps, {});
      const auto root = frozen.weights().asDiagonal();  // M^1/2
      CHECK((frozen.apply(root * before) - root * after).norm() < 1e-4 * (root * before).norm());
      ++compared;
      for (const ContactStatus s : statuses[last])
        sliding += s == ContactStatus::slide_forward || s == ContactStatus::slide_backward;
    }
    CHECK(compared > 0);
    CHECK(sliding > 0);
  }
}

TEST_CASE("predicted and observed rates agree, without friction whatever the coefficient of the case") {
  Simulation simulation = sheared_box(40, {2, 1}, "frictionless");
  simulation.dynamics.solver.gauss_seidel_sweeps = 10;
  simulation.dynamics.solver.criterion = "none";
  simulation.dynamics.solver.maximum_iterations = 20000;
  const PredictedObserved result = predicted_observed(simulation);
  REQUIRE(result.converged);
  REQUIRE(std::isfinite(result.observed));
  CHECK(std::abs(result.observed - result.predicted) < 0.05 * (1 - result.predicted));
}

TEST_CASE("predicted and observed rates agree with friction, where contacts slide") {
  // Boxes whose statuses stay long enough for the slowest mode to rule, one that is real.
  struct Box {
    Index grains, seed;
  };
  for (const Box box : {Box{40, 1}, {60, 2}}) {
    const Simulation sheared = box_with_turning_walls(box.grains, box.seed);
    for (const Index sweeps : {1, 10})
      for (const std::string eta : {"inf", "0.1"}) {
        INFO("grains = ", box.grains, ", sweeps = ", sweeps, ", eta = ", eta);
        Simulation simulation = sheared;
        StepSolver& solver = simulation.dynamics.solver;
        solver.algorithm = eta == "inf" ? "generic" : "enriched";
        if (eta != "inf") solver.eta = eta;
        solver.gauss_seidel_sweeps = sweeps;
        solver.criterion = "none";
        solver.maximum_iterations = 12000;
        const PredictedObserved result = predicted_observed(simulation);
        REQUIRE(result.converged);
        REQUIRE(std::isfinite(result.observed));
        CHECK(result.slide > 10);
        CHECK(result.stick > 10);
        CHECK(std::abs(result.observed - result.predicted) < 1e-4 * (1 - result.predicted));
      }
  }
}

TEST_CASE("the solution of a step, cut into subdomains, is a fixed point of Algorithm 1 with its interface impulses") {
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {3, 2}})
    for (const std::string algorithm : {"generic", "enriched", "schwarz"})
      for (const Index sweeps : {1, 3}) {
        INFO("grid[1] = ", grid[1], ", algorithm = ", algorithm, ", sweeps = ", sweeps);
        Simulation simulation = box_with_turning_walls(60, 2);
        StepSolver& solver = simulation.dynamics.solver;
        solver = {.algorithm = "auto", .criterion = Criterion::natural_map, .tolerance = 1e-13, .eta = "0.1"};
        const GranularStep<2> solution = solve_step(simulation);
        REQUIRE(solution.report.residual.relative_natural_map() < 1e-12);
        simulation.partitioner = GridPartitioner{grid};
        solver.algorithm = algorithm;
        solver.gauss_seidel_sweeps = sweeps;
        PreparedStep<2> step = prepare_solution(simulation);
        const Vector z = restart_at(step.iteration, solution.contacts);
        const Index unknowns = step.iteration.parts().interface_size();
        REQUIRE(z.tail(unknowns).norm() > 0.1 * z.norm());
        CHECK((step.iteration.state() - z).norm() < 1e-14 * z.norm());
        // Every copy has the velocity of its grain in the undivided packing.
        const double speed = largest_speed(solution.velocities, simulation.system.grains());
        for (const GranularSubdomain<2>& subdomain : step.iteration.parts().subdomains)
          for (std::size_t i = 0; i < subdomain.bodies.size(); ++i) {
            const GrainVelocity<2>&copy = subdomain.velocities[i],
                  &whole = solution.velocities[at(subdomain.bodies[i])];
            CHECK(std::hypot(copy.x - whole.x, copy.y - whole.y, copy.rim - whole.rim) < 1e-12 * speed);
          }
        for (int k = 0; k < 20; ++k) step.iteration.iterate();
        CHECK((step.iteration.state() - z).norm() < 1e-10 * z.norm());
        // Other interface impulses are left at once.
        Vector other = z;
        other.tail(unknowns) *= 1.001;
        step.iteration.restart(other);
        step.iteration.iterate();
        CHECK((step.iteration.state() - other).norm() > 1e-6 * z.norm());
      }
}

TEST_CASE("next to the solution of a step the rate of Algorithm 1 is the radius of its frozen iteration") {
  for (const Index grains : {40, 60})
    for (const Index sweeps : {1, 10})
      for (const std::string algorithm : {"generic", "enriched", "schwarz"}) {
        INFO("grains = ", grains, ", sweeps = ", sweeps, ", algorithm = ", algorithm);
        Simulation simulation = box_with_turning_walls(grains, grains == 40 ? 1 : 2);
        StepSolver& solver = simulation.dynamics.solver;
        solver.algorithm = algorithm;
        solver.eta = "0.1";
        solver.gauss_seidel_sweeps = sweeps;
        solver.maximum_iterations = 10000;
        const RateAtSolution rate = rate_at_solution(simulation);
        REQUIRE(rate.known());
        CHECK(rate.report.residual.relative_natural_map() < 1e-12);
        CHECK(rate.drift < 1e-11);
        CHECK(rate.changed == 0);
        CHECK(rate.iterations == 10000);
        CHECK(rate.slide > 10);
        CHECK(rate.stick > 10);
        CHECK(rate.relative_gap() < 1e-5);
        if (sweeps == 10) CHECK(rate.predicted_exact < rate.predicted);
      }
}

TEST_CASE("margin of a status: what an impulse or a velocity lacks to the next corner of the law") {
  std::vector<GrainVelocity<2>> v{{.inverse_mass = 0}, {.inverse_mass = 2}};
  GrainContact<2> c{.a = 0,
                    .b = 1,
                    .normal = {0, 1},
                    .inverse_mass_a = v[0].inverse_mass,
                    .inverse_mass_b = v[1].inverse_mass,
                    .friction = 0.5};
  const auto margin = [&](const ContactLaw& law) { return status_margin<2>(law, c, v); };
  v[1].y = 3;  // parts at 3 m/s; W_nn is 2/kg, W_tt 6/kg
  CHECK(margin(Coulomb{}) == doctest::Approx(1.5));
  c.bias.n = -1;
  CHECK(margin(Coulomb{}) == doctest::Approx(1));
  c.bias.n = v[1].y = 0;
  c.impulse = {4, -1.8};  // sticks; the edge is at 2
  CHECK(margin(Coulomb{}) == doctest::Approx(0.2));
  CHECK(margin(Frictionless{}) == doctest::Approx(4));
  c.impulse = {4, 0};
  CHECK(margin(Coulomb{}) == doctest::Approx(2));
  c.friction = 3;
  CHECK(margin(Coulomb{}) == doctest::Approx(4));
  c.friction = 0.5;
  c.impulse = {4, -2};  // slides at 6 m/s
  v[1].x = -6;
  CHECK(margin(Coulomb{}) == doctest::Approx(1));
  v[1].x = 0;
  c.impulse = {-2, 0};  // held by a pull of 3
  c.pull = 3;
  CHECK(margin(Cohesive{3}) == doctest::Approx(0.5));
}

TEST_CASE("a rate is not predicted for iterations that are not the frozen one") {
  Simulation simulation = sheared_box(20, {2, 1});
  simulation.dynamics.solver.interface_method = "conjugate_gradient";
  CHECK_THROWS_WITH_AS(predicted_observed(simulation), doctest::Contains("solver.interface_method"), Error);
  simulation.dynamics.solver.interface_method = "richardson";
  simulation.dynamics.solver.contact_relaxation = 1.2;
  CHECK_THROWS_WITH_AS(predicted_observed(simulation), doctest::Contains("contact_relaxation"), Error);
  simulation.dynamics.solver.contact_relaxation = 1;
  simulation.dynamics.solver.algorithm = "nlgs";
  CHECK_THROWS_WITH_AS(predicted_observed(simulation),
                       doctest::Contains("solver.algorithm: expected generic, enriched or schwarz for a rate that is "
                                         "predicted, met nlgs"),
                       Error);
  simulation = sheared_box(20, {1, 1});
  CHECK_THROWS_WITH_AS(predicted_observed(simulation), doctest::Contains("two subdomains or more"), Error);
}
