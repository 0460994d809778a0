// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of colours with a friction and restitutions of their own, or that do not touch; cohesion within a range.
#include "simulation/contact_pairs.hpp"

#include "../support/granular.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

BoundarySpec free_pair(Index first, double x, double y) {
  return clump("pair " + std::to_string(first), first, first + 1, {x, y}, 2, 1);
}

// Contacts of the first step, which all bodies touch in.
struct FirstStep {
  Simulation simulation;
  StepProblem<2> problem = prepare_step<2>(start_of(simulation), false);

  const GrainContact<2>* contact(Index a, Index b) const {
    for (std::size_t k = 0; k < problem.contacts.size(); ++k)
      if (problem.geometry[k].a == a && problem.geometry[k].b == b) return &problem.contacts[k];
    return nullptr;
  }
  double friction(Index a, Index b) const {
    REQUIRE(contact(a, b) != nullptr);
    return contact(a, b)->friction;
  }
};

// Two disks side by side on a floor, and a third one on top of each, of colours a, b, b and none; the floor is white.
Dynamics coloured_floor(const std::vector<PairSpec>& pairs) {
  Dynamics dynamics = tight({floor_wall()});
  dynamics.boundaries[0].colour = "white";
  dynamics.interaction.friction = 0.3;
  dynamics.interaction.boundary_friction = 0.6;
  dynamics.colours = {{"a", 0, 0}, {"b", 1, 2}};
  dynamics.pairs = pairs;
  dynamics.time.step = 1e-3;
  return dynamics;
}
const std::vector<Grain> four_disks{{.x = 0, .y = 0.5, .velocity_x = 1, .velocity_y = -2},
                                    {.x = 1, .y = 0.5, .velocity_y = -2},
                                    {.x = 0, .y = 1.5, .velocity_y = -3},
                                    {.x = 1, .y = 1.5, .velocity_y = -3}};

}  // namespace

TEST_CASE("pairs: contacts have the friction of their pair of colours, others that of grains or boundaries") {
  const Index floor = 4;
  const FirstStep step{simulation_of(
      four_disks, coloured_floor({{{"b", "a"}, {.friction = 0.1}}, {{"white", "b"}, {.friction = 0.2}}}))};
  CHECK(step.friction(0, 1) == 0.1);
  CHECK(step.friction(0, 2) == 0.1);
  CHECK(step.friction(1, 3) == 0.3);
  CHECK(step.friction(0, floor) == 0.6);
  CHECK(step.friction(1, floor) == 0.2);
  Dynamics rough = coloured_floor({{{"b", "a"}, {.friction = 0.1, .static_friction = 0.4}},
                                   {{"b", "b"}, {.static_friction = 0.7}},
                                   {{"white", "b"}, {.friction = 0.2}}});
  rough.interaction.static_friction = 0.5;
  const FirstStep rests{simulation_of(four_disks, rough)};  // nothing has slid before
  CHECK(rests.friction(0, 1) == 0.4);
  CHECK(rests.friction(1, 3) == 0.5);
  CHECK(rests.friction(0, floor) == 0.6);  // boundaries with a friction of their own have one
  CHECK(rests.friction(1, floor) == 0.2);
  Dynamics slippery = coloured_floor({{{"b", "a"}, {.friction = 0.1}}});
  slippery.interaction.law = "frictionless";
  CHECK(FirstStep{simulation_of(four_disks, slippery)}.friction(0, 1) == 0);
}

TEST_CASE("pairs: contacts have the restitutions of their pair of colours") {
  Dynamics dynamics = coloured_floor(
      {{{"b", "a"}, {.restitution = 0.5}}, {{"white", "a"}, {.restitution = 0, .tangential_restitution = 0.25}}});
  dynamics.interaction.signorini = Signorini::velocity;
  dynamics.interaction.restitution = 0.8;
  const FirstStep step{simulation_of(four_disks, dynamics)};
  REQUIRE(step.contact(0, 2) != nullptr);
  CHECK(step.contact(0, 2)->bias.n == doctest::Approx(0.5 * -1).epsilon(1e-3));  // disk 0 moves to the side
  CHECK(step.contact(1, 3)->bias.n == doctest::Approx(0.8 * -1));
  CHECK(step.contact(0, 4)->bias.n == 0);
  CHECK(std::abs(step.contact(0, 4)->bias.t) == doctest::Approx(0.25 * 1));
  CHECK(step.contact(1, 4)->bias.n == doctest::Approx(0.8 * -2));
  CHECK(step.contact(1, 4)->bias.t == 0);
}

TEST_CASE("pairs: a disk falls through a floor whose colour it does not touch; others bounce as their pair says") {
  Dynamics dynamics = coloured_floor({{{"white", "a"}, {.touch = false}}, {{"white", "b"}, {.restitution = 0.5}}});
  dynamics.interaction.signorini = Signorini::velocity;
  dynamics.interaction.restitution = 1;
  dynamics.time.gravity = {0, 0};
  Simulation simulation = simulation_of({{.x = 0, .y = 0.51, .velocity_y = -2},
                                         {.x = 3, .y = 0.51, .velocity_y = -2},
                                         {.x = 6, .y = 5},
                                         {.x = 9, .y = 0.51, .velocity_y = -2}},
                                        dynamics);
  advance(simulation, 20);
  CHECK(simulation.state.velocity_y[0] == -2);
  CHECK(simulation.state.velocity_y[1] == doctest::Approx(1).epsilon(1e-12));
  CHECK(simulation.state.velocity_y[3] == doctest::Approx(2).epsilon(1e-12));
}

TEST_CASE("pairs: a wholly free body is no boundary, one that is driven along a direction is") {
  BoundarySpec half = free_pair(2, 0.5, 1.5);
  half.body->directions = {false, true};
  Dynamics dynamics = coloured_floor({});
  dynamics.boundaries.push_back(free_pair(0, 0.5, 0.5));
  dynamics.boundaries.push_back(half);
  const FirstStep step{simulation_of(four_disks, dynamics)};
  CHECK_FALSE(step.simulation.system.is_boundary(0));
  CHECK(step.simulation.system.is_boundary(2));
  CHECK(step.friction(0, 4) == 0.6);  // of the floor
  CHECK(step.friction(0, 2) == 0.6);
  CHECK(step.contact(0, 1) == nullptr);  // of one body
  dynamics.boundaries.back() = free_pair(2, 0.5, 1.5);
  CHECK(FirstStep{simulation_of(four_disks, dynamics)}.friction(0, 2) == 0.3);
}

TEST_CASE("cohesion acts up to its range: a disk below another is drawn to it, or falls") {
  for (const auto& [gap, held] : {std::pair(0.8e-3, true), {2e-3, false}}) {
    Dynamics dynamics = tight({driven_grains("above", 0, 0)});
    dynamics.interaction.law = "cohesive";
    dynamics.interaction.cohesion = 40;
    dynamics.interaction.cohesion_range = 1e-3;
    dynamics.time.step = 1e-3;
    Simulation simulation = simulation_of({{.y = 0}, {.y = -1 - gap}}, dynamics);
    advance(simulation, 20);
    if (held) {
      CHECK(simulation.state.y[1] == doctest::Approx(-1).epsilon(1e-4));
      CHECK(std::abs(simulation.state.velocity_y[1]) < 1e-9);
    } else {
      CHECK(simulation.state.velocity_y[1] == doctest::Approx(-g * 0.02).epsilon(1e-9));
    }
    Dynamics touching = dynamics;
    touching.interaction.cohesion_range = -1;  // only what touches
    Simulation other = simulation_of({{.y = 0}, {.y = -1 - gap}}, touching);
    advance(other, 20);
    CHECK(other.state.velocity_y[1] == doctest::Approx(-g * 0.02).epsilon(1e-9));
  }
}

TEST_CASE("pairs: ranges and colours that fit nothing are refused") {
  const auto refused = [](const std::vector<ColourSpec>& colours, const std::vector<PairSpec>& pairs,
                          const char* words) {
    Dynamics dynamics = coloured_floor(pairs);
    dynamics.colours = colours;
    CHECK_THROWS_WITH_AS(simulation_of(four_disks, dynamics), doctest::Contains(words), Error);
  };
  refused({{"a", 0, 4}}, {{{"a", "a"}, {}}}, "colour[0].first: expected grains first <= last in 0..3");
  refused({{"a", 2, 1}}, {{{"a", "a"}, {}}}, "colour[0].first");
  refused({{"a", 0, -1}}, {{{"a", "white"}, {}}, {{"white", "a"}, {}}}, "pair[1].colours: expected each pair once");
  refused({{"a", 0, -1}}, {{{"a", "black"}, {}}}, "pair[0].colours");
}
