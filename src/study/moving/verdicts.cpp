// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/moving/moving_tables.hpp"
#include "study/moving/solver_trial.hpp"
#include <nscdd/contact_solvers/verdict.hpp>

namespace nscdd {
namespace {

constexpr Index most_sweeps = 20'000;

// The verdict on a step, and what it takes to solve it.
struct JudgedStep {
  const std::string& name;  // of the case
  Index step = 0, contacts = 0;
  double scale = 0;  // max |q_c|, m/s
  Verdict verdict = {};
  SolverTrial accelerated = {}, automatic = {};
};

ResultColumns<JudgedStep> judged_step_columns() {
  using Step = JudgedStep;
  return {
      {"case", "", "name of the case", [](const Step& s) { return s.name; }},
      {"step", "1", "step that is judged, from 1", &Step::step},
      {"contacts", "1", "contacts of its problem", &Step::contacts},
      {"verdict", "", "exists, impossible or undecided", [](const Step& s) { return s.verdict.kind; }},
      {"scale", "m/s", "max |q_c|, the largest relative velocity without contact impulses", &Step::scale},
      {"margin", "m/s",
       "the largest s found with u_n - mu |u_t| >= s at every contact; the search ends once it exceeds `scale`",
       [](const Step& s) { return s.verdict.margin; }},
      {"margin_over_speed", "1", "the margin over |v'|, the speed of the bodies that gives it",
       [](const Step& s) { return s.verdict.speed > 0 ? s.verdict.margin / s.verdict.speed : not_a_number; }},
      {"normal_margin", "m/s", "the largest s found with u_n >= s at every contact; nan if a solution exists",
       [](const Step& s) { return s.verdict.normal_margin; }},
      {"chain", "1", "contacts of the self-stress that proves that no solution exists; 0 if there is none",
       [](const Step& s) { return count(s.verdict.chain); }},
      {"closing_speed", "m/s", "of this self-stress", [](const Step& s) { return s.verdict.closing_speed; }},
      {"verdict_factorisations", "1", "of the verdict", [](const Step& s) { return s.verdict.factorisations; }},
      {"accelerated_sweeps", "1", "sweeps of `accelerated` to 1e-6, at most 20 000",
       [](const Step& s) { return s.accelerated.sweeps; }},
      {"accelerated_residual", "1", "natural map at their end", [](const Step& s) { return s.accelerated.residual; }},
      {"status", "", "how `auto` ended, from zero impulses to 1e-8", [](const Step& s) { return s.automatic.status; }},
      {"residual", "1", "natural map at its end", [](const Step& s) { return s.automatic.residual; }},
      {"factorisations", "1", "of `auto`", [](const Step& s) { return s.automatic.factorisations; }}};
}

Index judge_steps(const ObservedCase& work) {
  const Index total = count(work.table.steps);
  const auto sink = as_rows(judged_step_columns(), work.sink);
  for (Index k = work.first; k < total && report(work.monitor, k, total); ++k) {
    const Index step = work.table.steps[at(k)];
    const LocalFrictionProblem problem = whole_contact_problem(simulation_at(work, step - 1));
    bool stopped = false;
    const auto go_on = [&] { return !(stopped = stopped || !report(work.monitor, k, total)); };
    JudgedStep one{.name = work.one.spec.name, .step = step, .contacts = problem.contacts()};
    for (Index c = 0; c < problem.contacts(); ++c)
      one.scale = std::max(one.scale, problem.q.segment(problem.dimension * c, problem.dimension).norm());
    one.verdict = verdict_of(problem);
    one.accelerated = try_solver(
        problem, {.algorithm = FrictionAlgorithm::accelerated, .tolerance = 1e-6, .maximum_sweeps = most_sweeps},
        infinity, go_on);
    one.automatic = try_solver(problem, {}, infinity, go_on);
    if (stopped) break;
    sink(one);
  }
  return 0;  // steps without a solution are results
}

}  // namespace

constinit const Observable observables::verdicts = {
    .name = "verdicts",
    .summary =
        "contact problems of steps of a case that moves: whether they have a solution, and what it takes to find",
    .keys = {"steps", "lead_in"},
    .columns = [](const StudyTable&) { return headings(judged_step_columns()); },
    .run = judge_steps,
    .rows = row_per_step,
    .known = known_step,
    .moving = true,
    .check = require_open_contacts};

}  // namespace nscdd
