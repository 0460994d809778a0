// SPDX-License-Identifier: GPL-3.0-or-later
// Near a solution the algorithm is in space the linear map that FrozenIteration says it is, to first order: against
// differences of the run itself, its rate, the limit of many sweeps, and disks.
#include "../support/spheres.hpp"
#include "linalg/random.hpp"
#include "simulation/step_decomposition.hpp"
#include "study/moving/compared_rates.hpp"
#include "two_stage/frozen_iteration.hpp"
#include <nscdd/packing/generator.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Spheres in a box whose side walls turn about their feet, both the same way, some steps on: contacts stick and slide.
Simulation sheared_bed(Index grains, Index seed, Index steps = 3, const Components<Index>& grid = {2, 1, 1}) {
  const double width = 0.3 * std::cbrt(static_cast<double>(grains));
  const SphereDeposit deposit{
      .grains = grains, .width = width, .sizes = {.radius_min = 0.1, .radius_max = 0.198}, .seed = seed};
  const Packing packing = with_masses(generate(Generator{deposit}), {.model = MassModel::density, .density = 2500});
  const Motion turning = moving_in_space(Vector3::Zero(), Vector3(0, 0.075, 0));
  const Motion turning_too = moving_in_space(Vector3::Zero(), Vector3(0, 0.075, 0), Vector3(width, 0, 0));
  Dynamics dynamics;
  dynamics.time.maximum_push_speed = infinity;
  dynamics.boundaries = {
      plane("floor", Vector3::Zero(), Vector3::UnitZ()), plane("left", Vector3::Zero(), Vector3::UnitX(), turning),
      plane("right", Vector3(width, 0, 0), -Vector3::UnitX(), turning_too),
      plane("front", Vector3::Zero(), Vector3::UnitY()), plane("back", Vector3(0, width, 0), -Vector3::UnitY())};
  GranularScene made = scene(packing, dynamics);
  Simulation simulation{made.system, made.state, dynamics, GridPartitioner{grid}};
  advance_in_space(simulation, steps);
  return simulation;
}

GranularStep<3> solved_to_rounding(Simulation simulation) {
  simulation.dynamics.solver.tolerance = 1e-13;
  GranularStep<3> solution = solve_step<3>(simulation);
  REQUIRE(solution.report.residual.relative_natural_map() < 1e-12);
  return solution;
}

Simulation cut(Simulation simulation, const std::string& algorithm, Index sweeps) {
  StepSolver& solver = simulation.dynamics.solver;
  solver.algorithm = algorithm;
  solver.gauss_seidel_sweeps = sweeps;
  solver.criterion = "none";
  solver.maximum_iterations = 10000;
  return simulation;
}

Index count_of(const std::vector<ContactStatus>& statuses, ContactStatus status) {
  return std::ranges::count(statuses, status);
}

// The same step with spheres of the masses of the disks in the plane z = 0.
StepProblem<3> with_spheres(const StepProblem<2>& disks) {
  StepProblem<3> result{.law = disks.law,
                        .scale = disks.scale,
                        .friction = disks.friction,
                        .boundary_friction = disks.boundary_friction,
                        .h = disks.h,
                        .geometry = disks.geometry,
                        .contacts = {},
                        .start = {},
                        .free = {},
                        .numbers = disks.numbers};
  for (const GrainContact<2>& c : disks.contacts)
    result.contacts.push_back({.a = c.a,
                               .b = c.b,
                               .normal = {c.normal[0], c.normal[1], 0},
                               .inverse_mass_a = c.inverse_mass_a,
                               .inverse_mass_b = c.inverse_mass_b,
                               .friction = c.friction});
  for (const GrainVelocity<2>& v : disks.free) result.free.push_back({.inverse_mass = v.inverse_mass});
  return result;
}

// y of the velocities and impulses of a decomposition; linear in both, so an error is a difference of two.
Vector coordinates(const GranularDecomposition<3>& parts, const std::vector<FrozenContact<3>>& frozen,
                   const Vector& weights) {
  const Vector velocities = parts.free_velocities();
  Vector y(weights.size());
  y.head(velocities.size()) = velocities;
  Index row = velocities.size();
  for (const GranularSubdomain<3>& subdomain : parts.subdomains)
    for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
      if (const FrozenContact<3>& now = frozen[at(subdomain.numbers[k])]; now.turning > 0)
        y[row++] = dot(side_of(now), subdomain.contacts.impulse(k).t);
  return y.cwiseProduct(weights);
}

}  // namespace

TEST_CASE("frozen iteration of spheres: the derivative of the algorithm at a solution, turning impulses included") {
  for (const Index seed : {1, 2}) {
    const Simulation bed = sheared_bed(60, seed);
    const GranularStep<3> solution = solved_to_rounding(bed);
    for (const std::string algorithm : {"generic", "enriched"})
      for (const Index sweeps : {1, 3}) {
        INFO("seed = ", seed, ", algorithm = ", algorithm, ", sweeps = ", sweeps);
        PreparedStep<3> step = prepare_solution<3>(cut(bed, algorithm, sweeps));
        GranularTwoStage<3>& run = step.iteration;
        const Vector z = restart_at(run, solution.contacts);
        const std::vector<ContactStatus> statuses = run.statuses();
        REQUIRE(count_of(statuses, ContactStatus::open) > 10);
        REQUIRE(count_of(statuses, ContactStatus::stick) > 10);
        REQUIRE(count_of(statuses, ContactStatus::slide) > 10);
        const std::vector<FrozenContact<3>> contacts = frozen_contacts(run.parts(), statuses);
        const FrozenIteration<3> frozen(run.parts(), contacts, sweeps, step.enriched);
        const Index velocities = run.parts().free_velocities().size();
        REQUIRE(frozen.rows() == velocities + count_of(statuses, ContactStatus::slide));
        Vector error = Vector::Zero(z.size());
        const Index gluing = run.parts().interface_size();
        error.tail(gluing) = 1e-7 * z.tail(gluing).norm() * RandomStream(3).normal_vector(gluing).normalized();
        // Of central differences the second order cancels.
        std::vector<Vector> errors(4, Vector::Zero(frozen.rows()));
        for (const double sign : {1.0, -1.0}) {
          run.restart(z + sign * error);
          for (Vector& one : errors) {
            one += sign / 2 * coordinates(run.parts(), contacts, frozen.weights());
            run.iterate();
            CHECK(run.statuses() == statuses);
          }
        }
        CHECK(errors[0].tail(frozen.rows() - velocities).norm() < 1e-6 * errors[0].norm());
        CHECK(errors[1].tail(frozen.rows() - velocities).norm() > 1e-2 * errors[1].norm());
        for (std::size_t k = 1; k < errors.size(); ++k) {
          CHECK((frozen.apply(errors[k - 1]) - errors[k]).norm() < 1e-6 * errors[0].norm());
          CHECK((frozen.apply(errors[0], static_cast<Index>(k)) - errors[k]).norm() < 1e-6 * errors[0].norm());
        }
      }
  }
}

TEST_CASE("frozen iteration of spheres: many sweeps are an exact Stage 1 at a solution") {
  for (const std::string algorithm : {"generic", "enriched"}) {
    const Simulation bed = sheared_bed(60, 1);
    const GranularStep<3> solution = solved_to_rounding(bed);
    PreparedStep<3> step = prepare_solution<3>(cut(bed, algorithm, 1));
    restart_at(step.iteration, solution.contacts);
    const GranularDecomposition<3>& parts = step.iteration.parts();
    const auto contacts = frozen_contacts(parts, step.iteration.statuses());
    const double exact = frozen_radius(frozen_contraction(parts, contacts, step.enriched)).value;
    const double many = frozen_radius(FrozenIteration(parts, contacts, 3000, step.enriched)).value;
    const double few = frozen_radius(FrozenIteration(parts, contacts, 1, step.enriched)).value;
    CHECK(many == doctest::Approx(exact).epsilon(1e-7));
    CHECK(std::abs(few - exact) > 1e-3);
  }
}

TEST_CASE("next to the solution of a step of spheres the rate of Algorithm 1 is the radius of its frozen iteration") {
  for (const Components<Index>& grid : {Components<Index>{2, 1, 1}, Components<Index>{2, 2, 1}}) {
    const Simulation bed = sheared_bed(60, 1, 3, grid);
    for (const Index sweeps : {1, 3})
      for (const std::string algorithm : {"generic", "enriched", "schwarz"}) {
        INFO("grid[1] = ", grid[1], ", sweeps = ", sweeps, ", algorithm = ", algorithm);
        Simulation simulation = cut(bed, algorithm, sweeps);
        if (algorithm == "schwarz") simulation.dynamics.solver.interface_relaxation = 0.45;
        const RateAtSolution rate = rate_at_solution(simulation);
        REQUIRE(rate.known());
        CHECK(rate.report.residual.relative_natural_map() < 1e-12);
        CHECK(rate.drift < 1e-11);
        CHECK(rate.changed == 0);
        CHECK(rate.slide > 10);
        CHECK(rate.stick > 10);
        CHECK(rate.relative_gap() < 1e-4);
      }
  }
}

TEST_CASE("predicted and observed rates of spheres agree along a run, where contacts slide") {
  // Beds whose statuses stay long enough for the slowest mode to rule, one that is real.
  struct Bed {
    Index seed, steps;
  };
  for (const Bed bed : {Bed{5, 6}, {3, 12}}) {
    const Simulation sheared = sheared_bed(60, bed.seed, bed.steps);
    for (const std::string algorithm : {"generic", "enriched"})
      for (const Index sweeps : {1, 3}) {
        INFO("seed = ", bed.seed, ", algorithm = ", algorithm, ", sweeps = ", sweeps);
        const PredictedObserved result = predicted_observed(cut(sheared, algorithm, sweeps));
        REQUIRE(result.converged);
        REQUIRE(std::isfinite(result.observed));
        CHECK(result.slide > 10);
        CHECK(result.stick > 10);
        CHECK(std::abs(result.observed - result.predicted) < 1e-3 * (1 - result.predicted));
      }
  }
}

TEST_CASE("frozen spheres in a plane have the rate of the disks, where contacts slide in the plane or are open") {
  // Rims take no part: normal velocities do not know of them. (They differ: 2 m / 5 of a sphere, m / 2 of a disk.)
  Dynamics dynamics = tight();
  dynamics.solver.algorithm = "generic";
  dynamics.interaction.friction = 0.3;
  const Simulation simulation = box_of_grains(40, dynamics, {2, 1});
  const StepProblem<2> disks = prepare_step<2>(start_of(simulation), false);
  const StepProblem<3> spheres = with_spheres(disks);
  const Partition partition = partition_step(simulation, disks.geometry);
  const auto flat = decompose(disks, partition, "natural", 1);
  const auto parts = decompose(spheres, partition, "natural", 1);
  const std::array<ContactStatus, 4> pattern{ContactStatus::slide_forward, ContactStatus::slide_backward,
                                             ContactStatus::slide_forward, ContactStatus::open};
  std::vector<ContactStatus> statuses;
  std::vector<FrozenContact<3>> frozen;
  for (std::size_t c = 0; c < disks.contacts.size(); ++c) {
    statuses.push_back(pattern[c % pattern.size()]);
    const auto [x, y] = disks.contacts[c].normal;
    const double slope = sliding_slope(statuses.back(), disks.contacts[c].friction);
    const bool open = statuses.back() == ContactStatus::open;
    frozen.push_back({.status = open ? ContactStatus::open : ContactStatus::slide,
                      .slope = in_frame(Direction<3>{x, y, 0}, std::array{-slope * y, slope * x, 0.0}).t});
  }
  const std::vector<FrozenContact<2>> in_plane = frozen_contacts(flat, statuses);
  const double exact = frozen_radius(frozen_contraction(flat, in_plane, {})).value;
  REQUIRE(exact > 0.1);
  CHECK(frozen_radius(frozen_contraction(parts, frozen, {})).value == doctest::Approx(exact).epsilon(1e-9));
  for (const Index sweeps : {1, 3}) {
    const double inexact = frozen_radius(FrozenIteration(flat, in_plane, sweeps, {})).value;
    CHECK(frozen_radius(FrozenIteration(parts, frozen, sweeps, {})).value == doctest::Approx(inexact).epsilon(1e-6));
  }
  // What turns moves spheres out of the plane, and no others.
  for (FrozenContact<3>& contact : frozen)
    if (contact.status == ContactStatus::slide) contact.turning = 1e-9;
  CHECK(frozen_radius(frozen_contraction(parts, frozen, {})).value == doctest::Approx(exact).epsilon(1e-6));
}
