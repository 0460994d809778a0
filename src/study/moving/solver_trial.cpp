// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/moving/solver_trial.hpp"

#include "core/fail.hpp"
#include "simulation/contact_solver_step.hpp"
#include "study/tables/study.hpp"

namespace nscdd {
namespace {

// Of one trial, because the seconds of a single short run are noise.
constexpr double seconds_wanted = 0.1;
constexpr int most_runs = 10;

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

// A trial on the contact problem of a step.
struct StepTrial {
  const std::string& name;  // of the case
  Index grains = 0, step = 0;
  SolverTrial trial;
};

ResultColumns<StepTrial> step_trial_columns() {
  return joined<StepTrial>({{{"case", "", "name of the case", [](const StepTrial& t) { return t.name; }},
                             {"grains", "1", "free grains", &StepTrial::grains},
                             {"step", "1", "step whose contact problem it is, from 1", &StepTrial::step}},
                            columns_of(&StepTrial::trial, trial_columns())});
}

std::vector<FrictionAlgorithm> solvers_of(const StudyTable& table) {
  return contact_solvers_named(table.contact_solvers, "contact_solvers");
}

Index run_trials(const ObservedCase& work) {
  const std::vector<FrictionAlgorithm> solvers = solvers_of(work.table);
  const Index each = count(solvers), total = count(work.table.steps) * each;
  const auto sink = as_rows(step_trial_columns(), work.sink);
  std::optional<LocalFrictionProblem> problem;
  Index grains = 0;
  bool stopped = false;
  for (Index k = work.first; k < total && !stopped; ++k) {
    const Index step = work.table.steps[at(k / each)];
    if (!problem || k % each == 0) {
      const Simulation simulation = work.lead_in.at(work.one, step - 1, work.table.lead_in).simulation;
      problem = whole_contact_problem(simulation);
      grains = simulation.system.free_grains();
    }
    const auto go_on = [&] { return !(stopped = !report(work.monitor, k, total)); };
    const SolverTrial trial = try_solver(*problem, {.algorithm = solvers[at(k % each)]}, infinity, go_on);
    if (stopped) break;
    sink({work.one.spec.name, grains, step, trial});
    stopped = !report(work.monitor, k + 1, total);
  }
  return 0;  // runs that do not converge are results
}

}  // namespace

LocalFrictionProblem whole_contact_problem(const Simulation& simulation) {
  return in_dimension(simulation.system, [&](auto dimension) {
    return contact_problem(whole_step<dimension()>(simulation), simulation.system);
  });
}

void require_open_contacts(const CaseSpec& spec) {
  const Interaction& interaction = spec.dynamics->interaction;
  if (!opens(contact_law(interaction, spec.dynamics->time.step, 1)))
    fail("interaction.law: expected a law with open contacts, met {}", to_string(interaction.law));
}

ResultColumns<SolverTrial> trial_columns() {
  using Trial = SolverTrial;
  ResultColumns<Trial> all{
      {"contacts", "1", "contacts of the problem", &Trial::contacts},
      {"solver", "", "contact solver", &Trial::solver},
      {"status", "",
       "how the run ended: status of the solver, time_limit, impossible (proved to have no solution), or refused "
       "(a problem that cannot be read)",
       &Trial::status},
      {"residual", "1", "natural map with rho = 1/W_nn of each contact, relative to max(|r|, |r^1|)", &Trial::residual},
      {"seconds", "s", "of the solver by the clock, without its checks", [](const Trial& t) { return t.all.seconds; }},
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
}

SolverTrial try_solver(const LocalFrictionProblem& problem, const FrictionSolverOptions& options, double time_limit,
                       const std::function<bool()>& go_on) {
  const auto start = Clock::now();
  SolverTrial best = try_once(problem, options, time_limit, go_on);
  for (int k = 1; k < most_runs && seconds_since(start) < seconds_wanted && best.status != "stopped"; ++k)
    if (SolverTrial again = try_once(problem, options, time_limit, go_on);
        again.status == best.status && again.all.seconds < best.all.seconds)
      best = std::move(again);
  return best;
}

std::vector<FrictionAlgorithm> contact_solvers_named(const std::vector<std::string>& names, const std::string& what) {
  std::vector<FrictionAlgorithm> solvers;
  const bool all = names == std::vector<std::string>{"all"};
  for (const std::string& name : all ? all_names<FrictionAlgorithm>() : names) {
    solvers.push_back(Choice<FrictionAlgorithm>::parse(name, what));
    if (std::ranges::count(solvers, solvers.back()) > 1)
      fail("{}: expected each solver once, met '{}' again", what, name);
  }
  return solvers;
}

constinit const Observable observables::contact_solvers = {
    .name = "contact_solvers",
    .summary = "contact problems of steps of a case that moves, each given to every contact solver",
    .keys = {"steps", "lead_in", "contact_solvers"},
    .columns = [](const StudyTable&) { return headings(step_trial_columns()); },
    .run = run_trials,
    .rows = [](const StudyTable& table) { return count(table.steps) * count(solvers_of(table)); },
    .known =
        [](const StudyTable& table, Index row) {
          const std::vector<FrictionAlgorithm> solvers = solvers_of(table);
          const Index each = count(solvers);
          return KnownCells{{"step", table.steps[at(row / each)]}, {"solver", to_cell(solvers[at(row % each)])}};
        },
    .moving = true,
    .check = require_open_contacts};

}  // namespace nscdd
