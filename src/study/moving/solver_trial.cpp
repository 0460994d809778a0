// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/moving/solver_trial.hpp"

#include "core/fail.hpp"

#include <chrono>

namespace nscdd {
namespace {

using Clock = std::chrono::steady_clock;

// Of one trial: the seconds of a short run say little.
constexpr double seconds_wanted = 0.1;
constexpr int most_runs = 10;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

SolverTrial try_once(const LocalFrictionProblem& problem, const FrictionSolverOptions& options, double time_limit,
                     const std::function<bool()>& go_on) {
  const auto start = Clock::now();
  const double sweep = 2.0 * std::max(1.0, static_cast<double>(problem.w.nonZeros()));
  SolverTrial trial{.solver = options.algorithm, .contacts = problem.contacts()};
  bool late = false;
  const FrictionSolution solution = solve_friction(problem, options, {}, [&](const FrictionSolution& check) {
    for (std::size_t k = 0; k < compared_residuals.size(); ++k)
      if (std::isnan(trial.first[k].seconds) && check.credible && check.state.residual <= compared_residuals[k])
        trial.first[k] = {check.seconds, check.operations / sweep};
    late = seconds_since(start) > time_limit;
    return !late && (!go_on || go_on());
  });
  trial.status = late && solution.status == FrictionStatus::stopped ? "time_limit" : to_string(solution.status);
  trial.residual = solution.state.residual;
  trial.driven_residual = solution.state.driven_residual;
  trial.all = {solution.seconds, solution.operations / sweep};
  trial.check_seconds = seconds_since(start) - solution.seconds;
  trial.sweeps = solution.sweeps;
  trial.factorisations = solution.factorisations;
  return trial;
}

}  // namespace

const ResultColumns<SolverTrial>& trial_columns() {
  static const auto columns = [] {
    using Trial = SolverTrial;
    ResultColumns<Trial> all{
        {"contacts", "1", "contacts of the problem", &Trial::contacts},
        {"solver", "", "contact solver", &Trial::solver},
        {"status", "", "how it ended; time_limit, or refused for a problem that cannot be read", &Trial::status},
        {"residual", "1", "natural map with rho = 1/W_nn of each contact, relative to max(|r|, |r^1|)",
         &Trial::residual},
        {"seconds", "s", "of the solver by the clock, without its checks",
         [](const Trial& t) { return t.all.seconds; }},
        {"check_seconds", "s", "of its checks by the clock", &Trial::check_seconds},
        {"work", "1", "floating-point operations over those of a sweep, 2 per entry of W",
         [](const Trial& t) { return t.all.work; }},
        {"sweeps", "1", "Gauss-Seidel sweeps done", &Trial::sweeps},
        {"factorisations", "1", "sparse matrices factorised", &Trial::factorisations}};
    for (std::size_t k = 0; k < compared_residuals.size(); ++k) {
      const auto name = [&](const char* what) { return fmt::format("{}_{:.0e}", what, compared_residuals[k]); };
      all.push_back({name("seconds"), "s", "the same until a check first met this residual; nan if none did",
                     [k](const Trial& t) { return t.first[k].seconds; }});
      all.push_back({name("work"), "1", "the same until a check first met this residual; nan if none did",
                     [k](const Trial& t) { return t.first[k].work; }});
    }
    return all;
  }();
  return columns;
}

SolverTrial try_solver(const LocalFrictionProblem& problem, const FrictionSolverOptions& options, double time_limit,
                       const std::function<bool()>& go_on) {
  const auto start = Clock::now();
  SolverTrial best = try_once(problem, options, time_limit, go_on);
  for (int k = 1; k < most_runs && seconds_since(start) < seconds_wanted && best.status != "stopped"; ++k)
    if (SolverTrial again = try_once(problem, options, time_limit, go_on); again.all.seconds < best.all.seconds)
      best = std::move(again);
  return best;
}

std::vector<FrictionAlgorithm> contact_solvers_named(const std::vector<std::string>& names, const std::string& what) {
  std::vector<FrictionAlgorithm> solvers;
  std::vector<std::string> wanted = names;
  if (names == std::vector<std::string>{"all"}) wanted = all_names<FrictionAlgorithm>();
  for (const std::string& name : wanted) {
    solvers.push_back(Choice<FrictionAlgorithm>::parse(name, what));
    if (std::ranges::count(solvers, solvers.back()) > 1)
      fail("{}: expected each solver once, met '{}' again", what, name);
  }
  return solvers;
}

}  // namespace nscdd
