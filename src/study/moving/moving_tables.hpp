// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/tables/study.hpp"

#include <concepts>

namespace nscdd {

/// `columns()`, or `columns(dimension)` with the dimension of the cases of a table.
template <auto columns>
auto columns_of_table(const StudyTable& table) {
  if constexpr (std::invocable<decltype(columns), Index>)
    return columns(dimension_of(table));
  else
    return columns();
}

/// The record of an observable of cases that move. `observe(work, step, sink)` computes the results at a step of the
/// table: the step examined, or the number of steps done (see Observable::first_step). It returns how many of them are
/// not known. For `columns` see columns_of_table.
template <auto columns, auto observe>
constexpr Observable at_steps(Observable record) {
  record.keys = {"steps", "lead_in"};
  record.moving = true;
  record.columns = [](const StudyTable& table) { return headings(columns_of_table<columns>(table)); };
  record.run = [](const ObservedCase& work) {
    const std::vector<Index>& steps = work.table.steps;
    const auto sink = as_rows(columns_of_table<columns>(work.table), work.sink);
    Index failed = 0;
    for (Index k = work.first; k < count(steps); ++k) {
      failed += observe(work, steps[at(k)], sink);
      if (work.table.observable->rows != nullptr && !report(work.monitor, k + 1, count(steps))) break;
    }
    return failed;
  };
  return record;
}

/// The case of a table after some steps.
inline Simulation simulation_at(const ObservedCase& work, Index steps) {
  const bool own = work.table.observable->own_solver;
  return work.lead_in.at(work.one, steps, own ? LeadInSolver::own : LeadInSolver(work.table.lead_in)).simulation;
}

/// A case with its solver.
struct SolvedCase {
  const std::string& name;
  const Simulation& simulation;
  StepReport report;  ///< of its last step

  const StepSolver& solver() const { return simulation.dynamics.solver; }
  double flexibility() const {
    return has_part(solver().algorithm, StepPart::enriched_stage_two) ? report.eta : infinity;
  }
};
ResultColumns<SolvedCase> solver_columns();

/// For tables with a row for each step: Observable::rows and Observable::known.
Index row_per_step(const StudyTable& table);
KnownCells known_step(const StudyTable& table, Index row);

/// A step of a case, and results on it: a `report` of the step, and whether the rest is `known()`.
template <class Result>
struct ExaminedStep {
  SolvedCase solver;
  Index step = 0;  ///< from 1
  Result found;
};

/// The record of an observable with a row for each step. `examine(simulation)` examines the next, `columns()`: of it.
template <auto columns, auto examine>
constexpr Observable examined_steps(Observable record) {
  using Step = ExaminedStep<decltype(examine(std::declval<const Simulation&>()))>;
  record.rows = row_per_step;
  record.known = known_step;
  return at_steps<[] {
    return joined<Step>({columns_of(&Step::solver, solver_columns()),
                         {{"step", "1", "step examined, from 1", &Step::step}},
                         columns_of(&Step::found, columns())});
  },
                  [](const ObservedCase& work, Index number, const Sink<Step>& sink) {
                    const Simulation simulation = simulation_at(work, number - 1);
                    const auto found = examine(simulation);
                    sink({{work.one.spec.name, simulation, found.report}, number, found});
                    return Index{!found.known()};
                  }>(record);
}

}  // namespace nscdd
