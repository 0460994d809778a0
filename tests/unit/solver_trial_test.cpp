// SPDX-License-Identifier: GPL-3.0-or-later
// What is told of a contact solver that is given a problem: how it ended, and what it took until which residual.
#include "study/moving/solver_trial.hpp"

#include "../support/fclib_files.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <thread>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

LocalFrictionProblem bodies(std::uint64_t seed = 5) { return reduce(random_bodies_problem(seed, 30, 60)); }

bool is_number(const Effort& effort) { return std::isfinite(effort.seconds) && std::isfinite(effort.work); }

}  // namespace

TEST_CASE("solver trial: every solver tells what it took, in the order of the residuals") {
  const LocalFrictionProblem problem = bodies();
  for (const FrictionAlgorithm solver : contact_solvers_named({"all"}, "solvers")) {
    CAPTURE(to_string(solver));
    const SolverTrial trial = try_solver(problem, {.algorithm = solver});
    const FrictionSolution found = solve_friction(problem, {.algorithm = solver});
    CHECK((trial.solver == solver && trial.contacts == 60));
    CHECK(trial.status == to_string(found.status));
    CHECK((trial.residual == found.state.residual && trial.sweeps == found.sweeps));
    CHECK(trial.factorisations == found.factorisations);
    CHECK(trial.check_seconds >= 0);
    Effort before{.seconds = 0, .work = 0};
    for (const Effort& first : trial.first) {
      if (!is_number(first)) continue;
      CHECK(first.seconds >= before.seconds);
      CHECK(first.work >= before.work);
      before = first;
    }
    CHECK(trial.all.seconds >= before.seconds);
    CHECK(trial.all.work >= before.work);
    CHECK(trial.all.work > 0);  // a solver that does not count its operations would win every comparison
    if (found.status == FrictionStatus::converged) CHECK(is_number(trial.first.back()));
  }
}

TEST_CASE("solver trial: a residual is met where a run to that tolerance ends, and a sweep is a unit of work") {
  const LocalFrictionProblem problem = bodies();
  FrictionSolverOptions options{.algorithm = FrictionAlgorithm::nlgs, .check_every = 1};
  const SolverTrial trial = try_solver(problem, options);
  REQUIRE(trial.status == "converged");
  CHECK(trial.all.work == doctest::Approx(static_cast<double>(trial.sweeps)));
  for (std::size_t k = 0; k < compared_residuals.size(); ++k) {
    options.tolerance = compared_residuals[k];
    CHECK(trial.first[k].work == doctest::Approx(static_cast<double>(solve_friction(problem, options).sweeps)));
  }
  CHECK(trial.first[0].work < trial.first[2].work);
}

TEST_CASE("solver trial: the time that checks take is not the solver's") {
  constexpr double pause = 0.03;
  Index checks = 0;
  const SolverTrial trial = try_solver(bodies(), {.algorithm = FrictionAlgorithm::nlgs}, infinity, [&] {
    std::this_thread::sleep_for(std::chrono::duration<double>(pause));
    return ++checks < 40;
  });
  CHECK(trial.check_seconds >= pause);
  CHECK(trial.all.seconds < 0.5 * trial.check_seconds);
}

TEST_CASE("solver trial: a time limit has a status of its own, a stop another") {
  const SolverTrial late = try_solver(bodies(), {.algorithm = FrictionAlgorithm::nlgs}, 1e-9);
  CHECK((late.status == "time_limit" && late.sweeps == 0));
  CHECK_FALSE(is_number(late.first.back()));
  const SolverTrial stopped =
      try_solver(bodies(), {.algorithm = FrictionAlgorithm::nlgs}, infinity, [] { return false; });
  CHECK(stopped.status == "stopped");
}

TEST_CASE("solver trial: a repetition that meets the time limit does not replace a run that converged") {
  const LocalFrictionProblem problem = bodies();
  const FrictionSolverOptions options{.algorithm = FrictionAlgorithm::nlgs};
  Index of_one_run = 0, checks = 0;
  solve_friction(problem, options, {}, [&](const FrictionSolution&) { return ++of_one_run > 0; });
  constexpr double limit = 0.5;  // far from what a run takes, which is repeated if that is below 0.1 s
  const SolverTrial trial = try_solver(problem, options, limit, [&] {
    if (++checks > of_one_run) std::this_thread::sleep_for(std::chrono::duration<double>(1.1 * limit));
    return true;
  });
  CHECK(trial.status == "converged");
  CHECK(trial.residual <= 1e-8);
}

TEST_CASE("solver trial: impulses that grow without end meet no residual") {
  const SolverTrial trial =
      try_solver(squeezed_grain(), {.algorithm = FrictionAlgorithm::nlgs, .maximum_sweeps = 100'000});
  CHECK(trial.residual < compared_residuals[0]);
  for (const Effort& first : trial.first) CHECK_FALSE(is_number(first));
}

TEST_CASE("solver trial: solvers are named, each once") {
  CHECK(contact_solvers_named({"all"}, "x").size() == all_names<FrictionAlgorithm>().size());
  CHECK(contact_solvers_named({"nlgs", "auto"}, "x") ==
        std::vector{FrictionAlgorithm::nlgs, FrictionAlgorithm::automatic});
  CHECK_THROWS_WITH_AS(contact_solvers_named({"nlgs", "nlgs"}, "x"), "x: expected each solver once, met 'nlgs' again",
                       Error);
  CHECK_THROWS_AS(contact_solvers_named({"none"}, "x"), Error);
}
