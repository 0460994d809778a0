// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/predicted_observed.hpp"
#include "study/steps.hpp"

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

// What these tables tell of a case and its solver.
struct SolverSummary {
  std::string name;  // of the case
  Index disks = 0;   // free ones
  StepAlgorithm algorithm = StepAlgorithm::nlgs;
  Index gauss_seidel_sweeps = 0;
  double eta = infinity;  // of the enriched Stage 2, 1/kg
  Index interface_size = 0;
};

const ResultColumns<SolverSummary>& solver_columns() {
  using Summary = SolverSummary;
  static const ResultColumns<Summary> columns{
      {"case", "", "name of the case", &Summary::name},
      {"grains", "1", "free disks", &Summary::disks},
      {"algorithm", "", "nlgs, generic or enriched", &Summary::algorithm},
      {"gauss_seidel_sweeps", "1", "n_GS, sweeps of Stage 1 per iteration", &Summary::gauss_seidel_sweeps},
      {"eta", "1/kg", "flexibility of the enriched Stage 2; inf for the generic one", &Summary::eta},
      {"interface_dofs", "1", "interface unknowns n_Gamma", &Summary::interface_size}};
  return columns;
}

SolverSummary summary(const Case& one, const Simulation& simulation, double eta, Index interface_size) {
  const StepSolver& solver = simulation.dynamics.solver;
  return {one.spec.name,
          simulation.system.free_disks(),
          solver.algorithm,
          solver.gauss_seidel_sweeps,
          solver.algorithm == StepAlgorithm::enriched ? eta : infinity,
          interface_size};
}

// One iteration of a step: Figures 9 and 11 of [ADI12].
struct Iteration {
  SolverSummary solver;
  IterationRow row;
};

const ResultColumns<Iteration>& indicator_columns() {
  static const auto columns = [] {
    ResultColumns<IterationRow> timeless = iteration_columns();  // the time differs from run to run
    std::erase_if(timeless, [](const auto& column) { return column.heading.name == "seconds"; });
    return joined<Iteration>({columns_of(&Iteration::solver, solver_columns()), columns_of(&Iteration::row, timeless)});
  }();
  return columns;
}

Index iterations(const ObservedCase& work, Index step, const Sink<Iteration>& sink) {
  const Simulation simulation = simulation_at(work, step - 1);
  std::vector<IterationRow> rows;
  const SolvedStep solved = solve_step(simulation, {[&](const IterationRow& row) { rows.push_back(row); }});
  const SolverSummary solver = summary(work.one, simulation, solved.report.eta, solved.report.interface_size);
  // All of the first iterations, then about forty per decade: what a logarithmic axis can show.
  for (const IterationRow& row : rows)
    if (const Index i = row.record.iteration; i <= 20 || begins_interval(i, 40) || &row == &rows.back())
      sink({solver, row});
  return 0;
}

// A run with the solver of the case: iterations, residuals, and how far it has taken the free disks from
// where plain Gauss-Seidel (LeadInSolver::plain) takes them.
struct WholeRun {
  SolverSummary solver;
  Index steps = 0;
  RunTotals totals;
  double distance_mean = 0, distance_maximum = 0;  // m
};

const ResultColumns<WholeRun>& run_columns() {
  using Totals = RunTotals;
  static const ResultColumns<Totals> totals{
      {"converged_steps", "1", "of them those that converged", &Totals::converged},
      {"iterations", "1", "of all steps", &Totals::iterations},
      {"natural_map", "1", "|natural map| / |r| of the velocities kept, the worst of all steps", &Totals::natural_map},
      {"gluing", "1", "jump at the interface at the last iteration, the largest of all steps", &Totals::gluing},
      {"kinetic", "J", "energy of the free disks at the end", &Totals::kinetic}};
  static const auto columns =
      joined<WholeRun>({columns_of(&WholeRun::solver, solver_columns()),
                        {{"steps", "1", "steps of the run", &WholeRun::steps}},
                        columns_of(&WholeRun::totals, totals),
                        {{"distance_mean", "m", "of the free disks at the end from those of plain Gauss-Seidel",
                          &WholeRun::distance_mean},
                         {"distance_maximum", "m", "the largest of these distances", &WholeRun::distance_maximum}}});
  return columns;
}

Index whole_run(const ObservedCase& work, Index steps, const Sink<WholeRun>& sink) {
  const Arrival own = work.lead_in.at(work.one, steps, LeadInSolver::own);
  const GranularState plain = work.lead_in.at(work.one, steps, LeadInSolver::plain).simulation.state;
  const GranularSystem& system = own.simulation.system;
  const GranularState& state = own.simulation.state;
  const RunTotals& totals = own.totals;
  WholeRun run{summary(work.one, own.simulation, totals.eta, totals.interface_size), steps, totals};
  for (Index i = 0; i < system.disks(); ++i) {
    if (!system.free(i)) continue;
    const double distance = std::hypot(state.x[at(i)] - plain.x[at(i)], state.y[at(i)] - plain.y[at(i)]);
    run.distance_mean += distance / static_cast<double>(system.free_disks());
    run.distance_maximum = std::max(run.distance_maximum, distance);
  }
  sink(run);
  return 0;
}

// Predicted beside observed rate of a step.
struct ComparedStep {
  SolverSummary solver;
  Index step = 0;  // from 1
  PredictedObserved rates;

  bool known() const { return rates.converged && !std::isnan(rates.observed); }
};

const ResultColumns<ComparedStep>& rate_columns() {
  using Rates = PredictedObserved;
  static const ResultColumns<Rates> rates{
      {"active", "1", "contacts with an impulse at the statuses compared", &Rates::active},
      {"stick", "1", "of them sticking", &Rates::stick},
      {"slide", "1", "of them sliding", &Rates::slide},
      {"predicted", "1", "spectral radius of the frozen iteration with n_GS sweeps", &Rates::predicted},
      {"predicted_exact", "1", "the same with an exact Stage 1; nan for large packings", &Rates::predicted_exact},
      {"complex_pair", "", "whether the dominant eigenvalue is one of a complex pair", &Rates::complex_pair},
      {"observed", "1",
       "rate fitted to the run; nan where no stretch of fixed statuses falls or grows enough, at one rate",
       &Rates::observed},
      {"observed_error", "1", "standard error of the fit, and what the rate drifts by along it",
       &Rates::observed_error},
      {"relative_gap", "1", "|observed - predicted| / (1 - predicted)", &Rates::relative_gap},
      {"agree", "", "whether that is at most 1 %, or the rates differ by at most three errors of the fit",
       &Rates::agree},
      {"rate_z", "1", "rate fitted to Z itself over the same iterations", &Rates::rate_z},
      {"first_iteration", "1", "first iteration fitted", &Rates::first},
      {"last_iteration", "1", "last iteration fitted", &Rates::last},
      {"iterations", "1", "iterations run", &Rates::iterations},
      {"status", "", "how the run ended", &Rates::status}};
  static const auto columns = joined<ComparedStep>(
      {columns_of(&ComparedStep::solver, solver_columns()),
       {{"step", "1", "step examined, from 1", &ComparedStep::step}},
       columns_of(&ComparedStep::rates, rates),
       {{"converged", "", "whether prediction and observation are both known", &ComparedStep::known}}});
  return columns;
}

Index compared_rates(const ObservedCase& work, Index step, const Sink<ComparedStep>& sink) {
  const Simulation simulation = simulation_at(work, step - 1);
  const PredictedObserved rates = predicted_observed(simulation);
  const ComparedStep result{summary(work.one, simulation, rates.eta, rates.interface_size), step, rates};
  sink(result);
  return Index{!result.known()};
}

Index row_per_step(const StudyTable& table) { return count(table.steps); }

KnownCells known_step(const StudyTable& table, Index row) {
  return {{table.observable->first_step == 0 ? "steps" : "step", table.steps[at(row)]}};
}

}  // namespace

constinit const Observable observables::indicators = at_steps<indicator_columns, iterations>(
    {.name = "indicators", .summary = "indicators of every iteration of a step of a case that moves"});

constinit const Observable observables::predicted_observed = at_steps<rate_columns, compared_rates>(
    {.name = "predicted_observed",
     .summary = "rate of a step with friction, predicted at its frozen statuses and observed",
     .rows = row_per_step,
     .known = known_step,
     .check = [](const CaseSpec& spec) { require_comparable(*spec.dynamics, spec.partition); }});

constinit const Observable observables::runs = at_steps<run_columns, whole_run>(
    {.name = "runs",
     .summary = "runs of a case that moves with its own solver: iterations, residuals, distance from Gauss-Seidel",
     .rows = row_per_step,
     .known = known_step,
     .first_step = 0,
     .own_solver = true});

}  // namespace nscdd
