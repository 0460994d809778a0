// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "simulation/contact_solver_step.hpp"
#include "study/moving/solver_trial.hpp"
#include "study/tables/study.hpp"

namespace nscdd {
namespace {

// A trial on the contact problem of a step.
struct StepTrial {
  const std::string& name;  // of the case
  Index grains = 0, step = 0;
  SolverTrial trial;
};

const ResultColumns<StepTrial>& columns() {
  static const auto all =
      joined<StepTrial>({{{"case", "", "name of the case", [](const StepTrial& t) { return t.name; }},
                          {"grains", "1", "free disks", &StepTrial::grains},
                          {"step", "1", "step whose contact problem it is, from 1", &StepTrial::step}},
                         columns_of(&StepTrial::trial, trial_columns())});
  return all;
}

std::vector<FrictionAlgorithm> solvers_of(const StudyTable& table) {
  return contact_solvers_named(table.contact_solvers, "contact_solvers");
}

void check_law(const CaseSpec& spec) {
  const Interaction& interaction = spec.dynamics->interaction;
  if (!opens(contact_law(interaction, spec.dynamics->time.step, 1)))
    fail("interaction.law: expected a law with open contacts, met {}", to_string(interaction.law));
}

Index run_trials(const ObservedCase& work) {
  const std::vector<FrictionAlgorithm> solvers = solvers_of(work.table);
  const Index each = count(solvers), total = count(work.table.steps) * each;
  const auto sink = as_rows(columns(), work.sink);
  std::optional<LocalFrictionProblem> problem;
  Index grains = 0;
  bool stopped = false;
  for (Index k = work.first; k < total && !stopped; ++k) {
    const Index step = work.table.steps[at(k / each)];
    if (!problem || k % each == 0) {
      const Simulation simulation = work.lead_in.at(work.one, step - 1, work.table.lead_in).simulation;
      problem = in_dimension(simulation.system, [&](auto dimension) {
        return contact_problem(whole_step<dimension()>(simulation), simulation.system);
      });
      grains = simulation.system.free_grains();
    }
    const auto go_on = [&] { return !(stopped = !report(work.monitor, k, total)); };
    const SolverTrial trial = try_solver(*problem, {.algorithm = solvers[at(k % each)]}, infinity, go_on);
    if (stopped) break;
    sink({work.one.spec.name, grains, step, trial});
    stopped = !report(work.monitor, k + 1, total);
  }
  return 0;  // what does not converge is what the table is about
}

}  // namespace

constinit const Observable observables::contact_solvers = {
    .name = "contact_solvers",
    .summary = "contact problems of steps of a case that moves, each given to every contact solver",
    .keys = {"steps", "lead_in", "contact_solvers"},
    .columns = [](const StudyTable&) { return headings(columns()); },
    .run = run_trials,
    .rows = [](const StudyTable& table) { return count(table.steps) * count(solvers_of(table)); },
    .known =
        [](const StudyTable& table, Index row) {
          const std::vector<FrictionAlgorithm> solvers = solvers_of(table);
          const Index each = count(solvers);
          return KnownCells{{"step", table.steps[at(row / each)]},
                            {"solver", std::string(to_string(solvers[at(row % each)]))}};
        },
    .moving = true,
    .check = check_law};

}  // namespace nscdd
