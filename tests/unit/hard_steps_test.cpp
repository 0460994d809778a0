// SPDX-License-Identifier: GPL-3.0-or-later
// Contact problems of steps with large friction, on which details of the contact solvers count: random ones are easy.
#include "../support/moving_case.hpp"
#include "../support/sanitized.hpp"
#include "formats/case/case_file.hpp"
#include "simulation/contact_solver_step.hpp"
#include "study/case/lead_in.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

struct Step {
  double friction;
  Index number;  // from 1
};

// Of the small shear test, about 220 contacts.
LocalFrictionProblem problem_of(const Step& step) {
  CaseSpec spec = parse_case(moving_case(), "small.toml");
  spec.dynamics->interaction.friction = step.friction;
  LeadIn lead_in;
  const Simulation before = lead_in.at(resolve(spec), step.number - 1).simulation;
  return contact_problem(whole_step<2>(before), before.system);
}

}  // namespace

TEST_CASE("continuation solves steps on whose way the smoothing has to grow again") {
  Index factorisations = 0;
  const std::vector<Step> steps{{0.7, 3}, {0.7, 20}, {0.7, 23}, {0.8, 4}, {0.9, 3}, {0.9, 21}};
  for (const Step& step : watched(steps)) {
    CAPTURE(step.friction);
    const LocalFrictionProblem problem = problem_of(step);
    CHECK(problem.contacts() > 200);
    Index seen = 0, most_unseen = 0;  // factorisations
    const FrictionSolution found =
        solve_friction(problem, {.algorithm = FrictionAlgorithm::continuation}, {}, [&](const FrictionSolution& now) {
          most_unseen = std::max(most_unseen, now.factorisations - seen);
          seen = now.factorisations;
          return true;
        });
    CHECK(most_unseen == 1);  // corrections and retreats are shown too, of which step 3 with 0.9 has nine
    CHECK(found.status == FrictionStatus::converged);
    CHECK(friction_state(problem, found.impulses).residual <= 1e-8);
    factorisations += found.factorisations;
  }
  CHECK(factorisations <= 600);  // 255 when written; 2 800 where the smoothing never grows
}

TEST_CASE("auto solves the same steps") {
  for (const Step& step : watched(std::vector<Step>{{0.5, 20}, {0.7, 18}, {0.8, 23}})) {
    const FrictionSolution found = solve_friction(problem_of(step));
    CHECK(found.status == FrictionStatus::converged);
  }
}
