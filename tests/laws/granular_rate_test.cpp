// SPDX-License-Identifier: GPL-3.0-or-later
// With the linear law the granular iteration is the one of the spectral analysis: the same map of F_Gamma,
// the same iterates where Stage 1 is inexact, and the rate that the spectrum foretells.
#include "../support/granular.hpp"
#include "../support/problems.hpp"
#include "simulation/step_decomposition.hpp"
#include "two_stage/two_stage.hpp"
#include <nscdd/ddm/contraction.hpp>
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// A lattice of random velocities; what the law adds to v is left out, so that the step is linear.
struct LinearStep {
  Simulation simulation;
  StepProblem<2> problem;
  Partition partition;
  Decomposition parts;  // the same, for the spectral code

  LinearStep(std::array<Index, 2> grid, bool with_floor) {
    Dynamics dynamics = tight();
    dynamics.solver.algorithm = "generic";
    if (with_floor) dynamics.boundaries = {wall("floor", {0, -0.5}, {1, -0.5})};
    simulation = shaken_lattice(5, 5, dynamics, grid);
    problem = prepare_step<2>(start_of(simulation), false);
    for (GrainContact<2>& c : problem.contacts) c.bias.n = 0;
    partition = partition_step(simulation, problem.geometry);
    parts = decompose(reference_problem(problem, simulation.system.grains()), partition_of_columns(partition, 2));
  }

  GranularTwoStage<2> iteration(double epsilon, double eta, Index sweeps, double omega = 1) const {
    StepSolver solver = swept().solver;
    solver.gauss_seidel_sweeps = sweeps;
    solver.interface_relaxation = omega;
    std::optional<InterfaceOperator> enriched;
    if (eta < infinity) {
      solver.algorithm = "enriched";
      enriched = InterfaceFamily(parts).at(eta);
    }
    GranularTwoStage<2> result(decompose(problem, partition, "natural", 1), LinearViscous{epsilon}, solver, enriched);
    result.start({});
    return result;
  }
};

Scheme scheme_of(double eta) {
  if (eta < infinity) return Enriched{.eta = eta};
  return Generic{};
}

// |change of F| from one iteration to the next when it has become small, mean of ten ratios.
double observed_rate(GranularTwoStage<2> iteration, Index most) {
  Vector before = iteration.interface_impulses(), change;
  double first = 0, last = 0;
  std::vector<double> logarithms;
  for (Index k = 0; k < most; ++k) {
    iteration.iterate();
    change = iteration.interface_impulses() - before;
    before = iteration.interface_impulses();
    last = change.norm();
    if (k == 0) first = last;
    logarithms.push_back(std::log(last));
    if (last < 1e-9 * first || last > 1e9 * first) break;
  }
  const std::size_t n = logarithms.size();
  return std::exp((logarithms[n - 1] - logarithms[n - 11]) / 10);
}

}  // namespace

TEST_CASE("linear law, exact Stage 1: changes of F follow the contraction operator, vector by vector") {
  for (const bool with_floor : {false, true})
    for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {2, 2}, {3, 2}})
      for (const double eta : {0.3, 2.0, infinity})
        for (const double omega : {1.0, 0.7}) {
          INFO("with_floor = ", with_floor, ", grid[0] = ", grid[0], ", eta = ", eta, ", omega = ", omega);
          const LinearStep step(grid, with_floor);
          const double epsilon = 1.0;
          GranularTwoStage<2> iteration = step.iteration(epsilon, eta, 400, omega);
          Contraction b = contraction(step.parts, scheme_of(eta), LinearViscous{epsilon});
          b.relaxation = omega;
          REQUIRE(b.rows() == iteration.interface_impulses().size());
          iteration.iterate();
          Vector before = iteration.interface_impulses(), change = before;
          REQUIRE(change.norm() > 0.1);
          for (int k = 0; k < 6; ++k) {
            iteration.iterate();
            const Vector next = iteration.interface_impulses() - before;
            before = iteration.interface_impulses();
            CHECK((next - b.apply(change)).norm() < 1e-9 * change.norm());
            change = next;
          }
        }
}

TEST_CASE("linear law, exact Stage 1: changes of F shrink by at most the spectral radius, and come near it") {
  // B is self-adjoint in the product of P: |d_{k+1}|_P / |d_k|_P never exceeds rho and grows with k.
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {2, 2}})
    for (const double eta : {0.1, 0.5, 4.0, infinity}) {
      INFO("grid[1] = ", grid[1], ", eta = ", eta);
      const LinearStep step(grid, true);
      const double epsilon = 0.4;
      const Contraction b = contraction(step.parts, scheme_of(eta), LinearViscous{epsilon});
      const double expected = spectral_radius(b).value;
      GranularTwoStage<2> iteration = step.iteration(epsilon, eta, 400);
      Vector f = iteration.interface_impulses();
      double size = 0, first = 0, ratio = 0;
      for (int k = 0; k < 200; ++k) {
        iteration.iterate();
        const Vector change = iteration.interface_impulses() - f;
        f = iteration.interface_impulses();
        const double now = std::sqrt(change.dot(b.preconditioner.apply(change)));
        if (k == 0) first = now;
        if (k > 0 && (now < 1e-9 * first || now > 1e9 * first)) break;
        if (k > 0) {
          CHECK(now / size < expected * (1 + 1e-6));
          CHECK(now / size > ratio * (1 - 1e-6));
          ratio = now / size;
        }
        size = now;
      }
      CHECK(ratio > 0.9 * expected);
    }
}

TEST_CASE("linear law, n_GS sweeps: the iterates are those of the spectral code's two-stage iteration") {
  for (const Index sweeps : {1, 3})
    for (const double eta : {0.7, infinity}) {
      INFO("sweeps = ", sweeps, ", eta = ", eta);
      const LinearStep step({2, 2}, true);
      const LinearViscous law{.epsilon = 0.5};
      GranularTwoStage<2> granular = step.iteration(law.epsilon, eta, sweeps);
      const TwoStageIteration linear(step.parts, law, InterfaceFamily(step.parts).at(eta), sweeps);
      const auto loads =
          impact_loads(step.parts, reference_problem(step.problem, step.simulation.system.grains()).arriving_velocity);
      Vector state = Vector::Zero(linear.rows());
      for (int k = 0; k < 5; ++k) {
        granular.iterate();
        state = linear.iterate(std::move(state), &loads);
        const Vector f = state.tail(linear.interface_size());
        CHECK((granular.interface_impulses() - f).norm() < 1e-10 * f.norm());
        Index row = 0;
        for (const GranularSubdomain<2>& subdomain : granular.parts().subdomains)
          for (const LocalVector<2>& r : subdomain.contacts.impulses) {
            CHECK(std::abs(r.n - state[row++]) < 1e-10);
            CHECK(std::abs(r.t - state[row++]) < 1e-10);
          }
      }
      // Not self-adjoint: the rate comes near the radius once other modes are gone, which takes its time.
      const MapRadius radius = inexact_radius(linear);
      if (std::abs(radius.dominant.imag()) > 1e-12) continue;  // a pair: changes of F do not just shrink
      CHECK(observed_rate(std::move(granular), 3000) == doctest::Approx(radius.value).epsilon(0.06));
    }
}
