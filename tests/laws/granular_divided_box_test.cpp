// SPDX-License-Identifier: GPL-3.0-or-later
// Algorithm 1 on boxes of grains of several sizes under gravity, with driven disks across the cuts: gluing
// holds free grains alone, any division comes to the velocities of the whole, and the network of Stage 2 may
// be that of the last step.
#include "../support/granular.hpp"
#include "linalg/random.hpp"
#include "simulation/step_decomposition.hpp"
#include <nscdd/packing/generator.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// 60 grains on a row of disks that moves to the right, with a column of disks at the left that turns about
// its foot and a wall at the right. The middle disk of the row is where a cut into two strips goes. `posts`:
// every so many grains one is driven upwards (which jams the others: to be divided, not solved), 0 for none.
Simulation box_on_disks(const std::string& law, Index posts = 0) {
  const Deposit deposit{.grains = 60, .width = 2.2, .sizes = {.radius_min = 0.1, .radius_max = 0.198}};
  const Packing packing = with_masses(generate(Generator{deposit}), {.model = MassModel::density, .density = 2500});
  Dynamics dynamics = swept();
  dynamics.interaction.law = law;
  dynamics.solver.warm_start = true;
  dynamics.solver.tolerance = 1e-6;
  dynamics.boundaries = {row_of_disks("floor", {-0.5, -0.4}, {2.7, -0.4}, 0.4, moving({0.3, 0, 0})),
                         row_of_disks("left", {-0.4, 0.4}, {-0.4, 3.6}, 0.4, moving({0, 0, -0.1}, {-0.4, -0.4})),
                         wall("right", {2.2, 0}, {2.2, 1})};
  for (Index i = 2; posts > 0 && i < deposit.grains; i += posts)
    dynamics.boundaries.push_back(driven_grains("post", i, i, moving({0, 0.05, 0})));
  GranularScene made = scene(packing, dynamics);
  return {made.system, made.state, dynamics, GridPartitioner{}};
}

// The same some steps after the fall began, with the impulses of the last one.
Simulation falling_box(const std::string& law) {
  Simulation simulation = box_on_disks(law);
  for (int k = 0; k < 30; ++k) take_step(simulation, solve_step(simulation));
  return simulation;
}

// Driven bodies that contacts of several subdomains touch.
Index shared_driven_bodies(const StepProblem<2>& problem, const GranularDecomposition<2>& parts) {
  Index shared = 0;
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    shared += problem.free[i].inverse_mass == 0 && parts.interface.multiplicity(static_cast<Index>(i)) > 1;
  return shared;
}

Simulation divided(const Simulation& whole, std::array<Index, 2> grid, const std::string& algorithm) {
  Simulation result = whole;
  result.partitioner = GridPartitioner{grid};
  result.dynamics.solver.algorithm = algorithm;
  result.dynamics.solver.gauss_seidel_sweeps = 5;
  return result;
}

// The columns that contacts had in the last step: none, the normal one where they slid, both where they stuck.
std::vector<char> columns_of_last_step(const Simulation& simulation, const StepProblem<2>& problem) {
  std::vector<char> kept;
  for (std::size_t k = 0; k < problem.contacts.size(); ++k) {
    const LocalVector<2> r = impulse_between(simulation.state, problem.geometry[k].a, problem.geometry[k].b);
    kept.push_back(r.n > 0);
    kept.push_back(r.n > 0 && std::abs(r.t) < problem.contacts[k].friction * r.n * (1 - 1e-9));
  }
  return kept;
}

}  // namespace

TEST_CASE("driven disks across the cuts: what is glued is free, each further copy once, and nothing else is") {
  const Simulation whole = box_on_disks("coulomb", 4);
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {1, 2}, {2, 2}, {3, 3}}) {
    INFO("grid ", grid[0], " x ", grid[1]);
    const PreparedStep<2> step = prepare_solution(divided(whole, grid, "generic"));
    const GranularDecomposition<2>& parts = step.iteration.parts();
    CHECK(shared_driven_bodies(step.share.problem, parts) > 0);
    std::vector<Index> glued(step.share.problem.free.size(), 0);
    for (const Gluing& one : parts.interface.gluing()) {
      REQUIRE(one.grain < whole.system.grains());
      CHECK(whole.system.free(one.grain));
      ++glued[at(one.grain)];
    }
    for (std::size_t i = 0; i < glued.size(); ++i) {
      const bool free = step.share.problem.free[i].inverse_mass > 0;
      CHECK(glued[i] == (free ? std::max<Index>(0, parts.interface.multiplicity(static_cast<Index>(i)) - 1) : 0));
    }
  }
}

TEST_CASE("driven disks, gravity, several sizes, no friction: any division comes to the velocities of the whole") {
  const Simulation whole = falling_box("frictionless");
  const Close reference = closely(whole);
  REQUIRE(reference.map < 1e-10);
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {2, 2}})
    for (const std::string algorithm : {"generic", "enriched"}) {
      INFO("grid ", grid[0], " x ", grid[1], ", algorithm = ", algorithm);
      Simulation simulation = divided(whole, grid, algorithm);
      simulation.dynamics.solver.eta = "0.05";  // grains weigh 80 to 300 kg
      const PreparedStep<2> prepared = prepare_solution(simulation);
      CHECK(shared_driven_bodies(prepared.share.problem, prepared.iteration.parts()) > 0);
      const Close step = closely(simulation);
      CHECK(step.interface_size > 0);
      CHECK(step.map < 1e-9);
      check_close(step, reference, 1e-7);
    }
}

TEST_CASE("driven disks, gravity, several sizes, friction: any division meets the contact law as the whole does") {
  constexpr double law_tolerance = 1e-8;
  const Simulation whole = falling_box("coulomb");
  const auto residual = [](const Close& step) {
    return relative_natural_map(step.contacts, velocities_of(step.problem, step.contacts));
  };
  const double of_whole = residual(closely(whole));
  CHECK(of_whole < law_tolerance);
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {2, 2}})
    for (const std::string network : {"all", "active"}) {
      INFO("grid ", grid[0], " x ", grid[1], ", network = ", network);
      Simulation simulation = divided(whole, grid, "enriched");
      simulation.dynamics.solver.eta = "0.2";
      simulation.dynamics.solver.network = network;
      const Close step = closely(simulation);
      CHECK(step.interface_size > 0);
      CHECK(step.gluing < 1e-9);
      CHECK(residual(step) < law_tolerance);
    }
}

TEST_CASE("friction, network active: Stage 2 has the columns that open, sliding and sticking contacts left") {
  Simulation simulation = divided(falling_box("coulomb"), {2, 2}, "enriched");
  simulation.dynamics.solver.network = "active";
  const PreparedStep<2> step = prepare_solution(simulation);
  const double eta = 0.2;
  const std::vector<char> columns = columns_of_last_step(simulation, step.share.problem);
  Index open = 0, slide = 0, stick = 0;
  for (std::size_t k = 0; k < columns.size(); k += 2) ++(columns[k] == 0 ? open : columns[k + 1] == 0 ? slide : stick);
  CHECK(open > 0);
  CHECK(slide > 0);
  CHECK(stick > 0);
  const Decomposition linear = decompose(reference_problem(step.share.problem, simulation.system.grains()),
                                         partition_of_columns(step.share.partition, 2));
  const InterfaceOperator expected = InterfaceFamily(restrict_contacts(linear, columns)).at(eta);
  const InterfaceOperator met = enriched_operator(simulation, step.share, eta);
  const InterfaceOperator all = InterfaceFamily(linear).at(eta);
  const Vector f = RandomStream(7).normal_vector(step.iteration.parts().interface_size());
  CHECK((met.apply(f) - expected.apply(f)).norm() < 1e-12 * expected.apply(f).norm());
  CHECK((met.apply(f) - all.apply(f)).norm() > 1e-3 * expected.apply(f).norm());
}
