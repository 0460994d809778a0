// SPDX-License-Identifier: GPL-3.0-or-later
// The flexibility from which Stage 2 is stable whatever the contacts do, and runs with eta = "optimal" on it.
#include "../support/granular.hpp"
#include "../support/problems.hpp"
#include "two_stage/granular_two_stage.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Largest eigenvalue of X_eta^-1 X_0, X_0 of some of the contacts, times omega.
double largest(const Decomposition& parts, double eta, double relaxation, const std::vector<char>& kept) {
  const Contraction b{InterfaceFamily(parts).at(eta), InterfaceFamily(restrict_contacts(parts, kept)).at(0.0)};
  const SpectralRadius radius = spectral_radius(b, {.solver = SpectralSolver::dense});
  REQUIRE(radius.converged);
  return relaxation * (1 - radius.eigenvalue_min);
}

// A box between walls that move, sheared so fast that contacts slide.
Simulation sheared_box(const std::string& algorithm, const std::string& eta, Index sweeps) {
  Dynamics dynamics = swept();
  dynamics.solver.algorithm = algorithm;
  dynamics.solver.eta = eta;
  dynamics.solver.gauss_seidel_sweeps = sweeps;
  dynamics.solver.tolerance = 1e-5;
  dynamics.solver.maximum_iterations = 20000;
  Simulation simulation = box_of_grains(80, dynamics, {2, 1});
  for (std::size_t i = 0; i < simulation.state.x.size(); ++i)
    simulation.state.velocity_x[i] = 0.3 * simulation.state.y[i];
  return simulation;
}

}  // namespace

TEST_CASE("stable eta: no set of contacts diverges from there up, some do below") {
  std::mt19937 random(7);
  int below = 0;
  on_every_interface([&](const Model& model) {
    const Decomposition& parts = model.parts;
    const std::vector<char> none(at(parts.contacts), 0);
    for (const double relaxation : {1.0, 1.5}) {
      const double eta = stable_eta(parts, relaxation);
      if (eta == 0) {
        CHECK(largest(parts, 1e-6, relaxation, none) <= 2);
        continue;
      }
      CHECK(largest(parts, eta, relaxation, none) == doctest::Approx(2).epsilon(2e-3));
      CHECK(largest(parts, eta / 2, relaxation, none) > 2);
      ++below;
      for (int draw = 0; draw < 5; ++draw) {
        std::vector<char> kept(at(parts.contacts));
        for (char& one_kept : kept) one_kept = random() % 2 == 0;
        CHECK(largest(parts, eta, relaxation, kept) <= 2 + 5e-3);
        CHECK(largest(parts, 3 * eta, relaxation, kept) <= 2);
      }
    }
  });
  CHECK(below > 5);
}

TEST_CASE("runs with eta = optimal converge, about as fast as the generic algorithm or faster") {
  for (const Index sweeps : {1, 10}) {
    CAPTURE(sweeps);
    Index iterations[2] = {0, 0};
    for (const bool enriched : {false, true}) {
      Simulation simulation = sheared_box(enriched ? "enriched" : "generic", "optimal", sweeps);
      for (int step = 0; step < 10; ++step) iterations[enriched] += advance(simulation).last.iteration;
    }
    CHECK(iterations[1] <= 1.1 * static_cast<double>(iterations[0]));
  }
}

TEST_CASE("eta = optimal kept between two decompositions is raised for the contacts that come") {
  Simulation simulation = sheared_box("enriched", "optimal", 1);
  simulation.dynamics.solver.redecompose = 1000;
  for (std::size_t i = 0; i < simulation.state.y.size(); ++i) {  // a loose heap that falls together
    simulation.state.y[i] *= 1.05;
    simulation.state.velocity_y[i] = -simulation.state.y[i];
  }
  advance(simulation);
  constexpr double kept = 0.04;  // 1/kg, stable for the contacts of the first steps
  simulation.state.eta = kept;
  int raised = 0, as_kept = 0;
  for (int step = 1; step < 10; ++step) {
    CAPTURE(step);
    GranularStep<2> solved = solve_step(simulation);
    const double stable = stable_eta(decompose(reference_problem(solved.problem, simulation.system.grains()),
                                               partition_of_columns(solved.partition, 2)));
    CHECK(solved.report.eta == doctest::Approx(std::max(kept, stable)).epsilon(2e-3));
    raised += solved.report.eta > kept;
    as_kept += solved.report.eta == kept;
    REQUIRE(solved.report.status == SolverStatus::converged);
    take_step(simulation, std::move(solved));
    CHECK(simulation.state.decomposed_at == 0);
    CHECK(simulation.state.eta == kept);
  }
  CHECK(raised > 0);
  CHECK(as_kept > 0);
}
