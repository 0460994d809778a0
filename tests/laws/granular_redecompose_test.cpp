// SPDX-License-Identifier: GPL-3.0-or-later
// solver.redecompose = k: a partition kept for k steps moves everything as a fresh one does, and takes in the
// contacts that appear meanwhile.
#include "../support/granular.hpp"
#include "simulation/step_decomposition.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Dynamics kept_for(Index steps, bool warm_start = false) {
  Dynamics dynamics = without_gravity({}, 0.005);
  dynamics.interaction.law = "frictionless";
  dynamics.solver.algorithm = "generic";
  dynamics.solver.gauss_seidel_sweeps = 5;
  dynamics.solver.tolerance = dynamics.solver.gluing_tolerance = 1e-11;
  dynamics.solver.redecompose = steps;
  dynamics.solver.warm_start = warm_start;
  return dynamics;
}

// Grains fall and sway through the cuts: after some steps a fresh partition is another one.
Simulation swaying_box(Dynamics dynamics) {
  dynamics.time.gravity = {0, -g};
  Simulation simulation = box_of_grains(40, dynamics, {2, 2});
  for (std::size_t i = 0; i < simulation.state.x.size(); ++i)
    simulation.state.velocity_x[i] = 2 * simulation.state.y[i];
  return simulation;
}

// Subdomain of the contact of a and b in the last step taken, -1 where there was none.
Index subdomain_of(const GranularState& state, Index a, Index b) {
  for (const RememberedSubdomain& one : state.subdomains)
    if (one.a == a && one.b == b) return one.subdomain;
  return -1;
}

// Contacts of both states that lie in different subdomains.
Index moved_contacts(const GranularState& one, const GranularState& other) {
  Index moved = 0;
  for (const RememberedSubdomain& c : one.subdomains) {
    const Index e = subdomain_of(other, c.a, c.b);
    moved += e >= 0 && e != c.subdomain;
  }
  return moved;
}

double state_difference(const GranularState& a, const GranularState& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i)
    largest = std::max({largest, std::abs(a.velocity_x[i] - b.velocity_x[i]),
                        std::abs(a.velocity_y[i] - b.velocity_y[i]), std::abs(a.spin[i] - b.spin[i])});
  return largest;
}

}  // namespace

TEST_CASE("frictionless: a partition kept for 10 steps gives the velocities of one made in every step") {
  for (const bool warm_start : {false, true}) {
    CAPTURE(warm_start);
    Simulation fresh = swaying_box(kept_for(1, warm_start)), kept = swaying_box(kept_for(10, warm_start));
    Index moved = 0, appeared = 0;
    for (int step = 0; step < 25; ++step) {
      CAPTURE(step);
      const GranularState before = kept.state;
      advance(fresh);
      REQUIRE(advance(kept).interface_size > 0);
      CHECK(state_difference(kept.state, fresh.state) < 1e-8);
      CHECK(kept.state.decomposed_at == step / 10 * 10);
      if (step % 10 == 0) {
        CHECK(moved_contacts(kept.state, fresh.state) == 0);
        continue;
      }
      CHECK(moved_contacts(kept.state, before) == 0);
      moved += moved_contacts(kept.state, fresh.state);
      for (const RememberedSubdomain& c : kept.state.subdomains) appeared += subdomain_of(before, c.a, c.b) < 0;
    }
    CHECK(moved > 10);
    CHECK(appeared > 10);
  }
}

TEST_CASE("a contact that appears between two decompositions is given to a neighbour's subdomain and solved") {
  // Two pairs meet: 0, 1 fly right in the left strip, 2, 3 left in the right one; above them two lone grains.
  const double gap = 0.06;
  std::vector<Grain> grains{{.x = 0, .velocity_x = 1},
                            {.x = 1, .velocity_x = 1},
                            {.x = 2 + gap, .velocity_x = -1},
                            {.x = 3 + gap, .velocity_x = -1},
                            {.x = 2.5, .y = 10, .velocity_x = 2},
                            {.x = 3.5 + gap, .y = 10}};
  for (const std::string algorithm : {"generic", "enriched"}) {
    CAPTURE(algorithm);
    Dynamics dynamics = kept_for(1000);
    dynamics.solver.algorithm = algorithm;
    Simulation simulation = simulation_of(grains, dynamics, {2, 1});
    advance(simulation);
    REQUIRE(subdomain_of(simulation.state, 0, 1) == 0);
    REQUIRE(subdomain_of(simulation.state, 2, 3) == 1);
    REQUIRE(subdomain_of(simulation.state, 1, 2) == -1);
    REQUIRE(subdomain_of(simulation.state, 4, 5) == -1);
    advance(simulation, 12);
    CHECK(simulation.state.decomposed_at == 0);
    // Of the two pairs that share a grain with it, the one of its first disk; nobody's contact goes to 0.
    CHECK(subdomain_of(simulation.state, 0, 1) == 0);
    CHECK(subdomain_of(simulation.state, 1, 2) == 0);
    CHECK(subdomain_of(simulation.state, 2, 3) == 1);
    CHECK(subdomain_of(simulation.state, 4, 5) == 0);
    // Equal masses, no restitution: the pairs stop each other, the lone grains share their momentum.
    for (const std::size_t i : {0U, 1U, 2U, 3U}) CHECK(std::abs(simulation.state.velocity_x[i]) < 1e-9);
    for (const std::size_t i : {4U, 5U}) CHECK(simulation.state.velocity_x[i] == doctest::Approx(1).epsilon(1e-9));
    CHECK(simulation.state.x[2] - simulation.state.x[1] == doctest::Approx(1).epsilon(1e-9));
  }
}
