// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/moving/interface_iterations.hpp"
#include "study/moving/moving_tables.hpp"

#include <fmt/format.h>

namespace nscdd {
namespace {

// Iterations at the interface of a step.
struct CutStep {
  SolvedCase solver;
  Index step = 0;  // from 1
  InterfaceIterations found;
};

ResultColumns<FrozenInterface> frozen_columns(const std::string& network, const std::string& words) {
  return {{"iterations_" + network, "1", "Krylov iterations of the last system with " + words + " in Stage 2",
           &FrozenInterface::iterations},
          {"predicted_" + network, "1", "the same from the spectrum of P^-1 S; nan above 2 500 unknowns",
           &FrozenInterface::predicted},
          {"richardson_" + network, "1", "Richardson iterations instead, from the spectral radius of I - P^-1 S",
           &FrozenInterface::richardson}};
}

ResultColumns<InterfaceIterations::Rival> rival_columns(const std::string& name, const std::string& words) {
  using Rival = InterfaceIterations::Rival;
  return {{name + "_iterations", "1", "of " + words, &Rival::iterations},
          {name + "_converged", "", "whether it got there within maximum_iterations", &Rival::converged}};
}

const ResultColumns<CutStep>& cut_columns() {
  using Found = InterfaceIterations;
  static const ResultColumns<Found> outer{
      {"subdomains", "1", "number of subdomains", &Found::subdomains},
      {"stick", "1", "contacts that stick at the end", &Found::stick},
      {"slide", "1", "contacts that slide at the end", &Found::slide},
      {"natural_map", "1", "|natural map| / max(|r|, |r^1|) at the end",
       [](const Found& f) { return f.report.residual.relative_natural_map(); }},
      {"outer_steps", "1", "matrices factorised in the step", [](const Found& f) { return f.report.factorisations; }},
      {"outer_steps_undivided", "1", "the same on one subdomain", &Found::undivided_factorisations},
      {"systems", "1", "systems solved at the interface, two for each linear system", &Found::systems},
      {"iterations_per_system", "1", "iterations at the interface, mean over these systems",
       &Found::iterations_per_system}};
  static const auto columns = joined<CutStep>(
      {columns_of(&CutStep::solver, solver_columns()),
       {{"step", "1", "step examined, from 1", &CutStep::step}},
       columns_of(&CutStep::found,
                  joined<Found>(
                      {outer, columns_of(&Found::none, frozen_columns("none", "no contacts")),
                       columns_of(&Found::all, frozen_columns("all", "all contacts")),
                       columns_of(&Found::active, frozen_columns("active", "the active contacts")),
                       columns_of(&Found::generic, rival_columns("generic", "the generic Algorithm 1, to zeta 1e-4")),
                       columns_of(&Found::enriched, rival_columns("enriched", "the enriched one with eta = 30 W")),
                       columns_of(&Found::admm, rival_columns("admm", "two-stage ADMM, to the tolerance"))})),
       {{"converged", "", "whether the step did",
         [](const CutStep& one) { return one.found.report.status == SolverStatus::converged; }}}});
  return columns;
}

Index cut_step(const ObservedCase& work, Index step, const Sink<CutStep>& sink) {
  const Simulation simulation = simulation_at(work, step - 1);
  const InterfaceIterations found = interface_iterations(simulation);
  sink({{work.one.spec.name, simulation, found.report}, step, found});
  return Index{found.report.status != SolverStatus::converged};
}

}  // namespace

constinit const Observable observables::interface_iterations = at_steps<cut_columns, cut_step>(
    {.name = "interface_iterations",
     .summary =
         "outer steps and iterations at the interface of a step by the two-stage Newton method, with those predicted",
     .rows = row_per_step,
     .known = known_step,
     .check = [](const CaseSpec& spec) {
       if (const StepSolver& solver = spec.dynamics->solver; solver.algorithm != StepAlgorithm::two_stage_newton)
         throw Error("solver.algorithm", fmt::format("expected {}, met {}", to_string(StepAlgorithm::two_stage_newton),
                                                     to_string(solver.algorithm)));
     }});

}  // namespace nscdd
