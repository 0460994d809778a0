// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/moving/moving_tables.hpp"

#include "core/fail.hpp"
#include "simulation/trajectory_step.hpp"

namespace nscdd {

ResultColumns<SolvedCase> solver_columns() {
  using One = SolvedCase;
  return {
      {"case", "", "name of the case", [](const One& one) { return one.name; }},
      {"grains", "1", "free grains", [](const One& one) { return one.simulation.system.free_grains(); }},
      {"algorithm", "", "solver of the steps", [](const One& one) { return to_string(one.solver().algorithm); }},
      {"gauss_seidel_sweeps", "1", "n_GS, sweeps of Stage 1 per iteration",
       [](const One& one) { return one.solver().gauss_seidel_sweeps; }},
      {"eta", "1/kg", "flexibility of the enriched Stage 2; inf for the generic one", &One::flexibility},
      {"eta_relative", "1", "the same in multiples of the mean of W_nn over the contacts considered",
       [](const One& one) { return one.flexibility() / one.report.scale; }},
      {"interface_dofs", "1", "interface unknowns n_Gamma", [](const One& one) { return one.report.interface_size; }}};
}

Index row_per_step(const StudyTable& table) { return count(table.steps); }

KnownCells known_step(const StudyTable& table, Index row) {
  return {{table.observable->first_step == 0 ? "steps" : "step", table.steps[at(row)]}};
}

namespace {

// The contacts of the next step, with their subdomains.
std::vector<TrajectoryContact> next_contacts(const ObservedCase& work, const Simulation& simulation) {
  return in_dimension(simulation.system, [&](auto dimension) {
    return trajectory_contacts(next_step<dimension()>(simulation, work.table.lead_in));
  });
}

struct PlacedGrain {
  const std::string& name;  // of the case
  const Simulation& simulation;
  Index number;
  const std::set<Index>& subdomains;
};

ResultColumns<PlacedGrain> grain_columns(Index dimension) {
  using One = PlacedGrain;
  return joined<One>(
      {{{"case", "", "name of the case", [](const One& grain) { return grain.name; }},
        {"step", "1", "steps done", [](const One& grain) { return grain.simulation.state.step; }},
        {"disk", "1", "number of the disk or sphere, grains first", &One::number}},
       vector_columns<One>(
           dimension, "{}", "m", "centre",
           [](const One& grain, Index k) { return centre_of(grain.simulation.state, at(grain.number))[at(k)]; }),
       {{"radius", "m", "radius", [](const One& grain) { return grain.simulation.system.radius[at(grain.number)]; }},
        {"angle", "rad", "angle turned by, in space from 0 to pi about some axis",
         [](const One& grain) {
           const GranularState& state = grain.simulation.state;
           const std::size_t i = at(grain.number);
           if (grain.simulation.system.dimension == 2) return state.angle[i];
           const double sine = std::hypot(state.turn_x[i], state.turn_y[i], state.turn_z[i]);
           return 2 * std::atan2(sine, std::abs(state.turn_w[i]));
         }},
        {"driven", "", "whether a boundary drives it",
         [](const One& grain) { return !grain.simulation.system.free(grain.number); }},
        {"subdomain", "1", "lowest subdomain that holds it; -1 without a contact",
         [](const One& grain) { return grain.subdomains.empty() ? -1 : *grain.subdomains.begin(); }},
        {"multiplicity", "1", "subdomains that hold it", [](const One& grain) { return grain.subdomains.size(); }}}});
}

Index placed_grains(const ObservedCase& work, Index steps, const Sink<PlacedGrain>& sink) {
  const Simulation simulation = simulation_at(work, steps);
  const auto held = subdomains_of_grains(next_contacts(work, simulation), simulation.system.grains());
  for (Index i = 0; i < count(held); ++i) sink({work.one.spec.name, simulation, i, held[at(i)]});
  return 0;
}

struct ChainContact {
  const std::string& name;              // of the case
  Index steps;                          // done before
  std::array<double, 3> first, second;  // centres, or the foot on a wall, m; in the plane z = 0
  double impulse_n, impulse_t;          // N s
  ContactStatus status;
  Index subdomain;
};

ResultColumns<ChainContact> chain_columns(Index dimension) {
  using Link = ChainContact;
  const auto ends = [=](const char* name, const char* description, std::array<double, 3> Link::*end) {
    return vector_columns<Link>(dimension, name, "m", description,
                                [=](const Link& c, Index k) { return (c.*end)[at(k)]; });
  };
  return joined<Link>(
      {{{"case", "", "name of the case", [](const Link& c) { return c.name; }},
        {"step", "1", "steps done before the one whose impulses these are", &Link::steps}},
       ends("{}_a", "centre of one grain", &Link::first),
       ends("{}_b", "centre of the other, or foot on a wall", &Link::second),
       {{"impulse_n", "N s", "normal impulse", &Link::impulse_n},
        {"impulse_t", "N s", "tangential impulse; in space its magnitude", &Link::impulse_t},
        {"status", "", "stick, slide_forward or slide_backward; in space stick or slide", &Link::status},
        {"subdomain", "1", "subdomain of the contact", &Link::subdomain}}});
}

Index chains(const ObservedCase& work, Index steps, const Sink<ChainContact>& sink) {
  const Simulation simulation = simulation_at(work, steps);
  const GranularState& state = simulation.state;
  for (const TrajectoryContact& c : next_contacts(work, simulation)) {
    if (!c.carries()) continue;
    const bool wall = c.geometry.b >= simulation.system.grains();
    const Place from = centre_of(state, at(c.geometry.a));
    Place to = wall ? c.geometry.point : centre_of(state, at(c.geometry.b));
    if (simulation.system.period.any()) to = moved_along(from, 1, simulation.system.apart(from, to));
    const double tangential = simulation.system.dimension == 2 ? c.impulse.t : c.tangential();
    sink({work.one.spec.name, state.step, from, to, c.impulse.n, tangential, c.status, c.subdomain});
  }
  return 0;
}

// One iteration of a step: Figures 9 and 11 of [ADI12].
struct Iteration {
  SolvedCase solver;
  IterationRow row;
};

ResultColumns<Iteration> with_solver(const ResultColumns<IterationRow>& rows) {
  return joined<Iteration>({columns_of(&Iteration::solver, solver_columns()), columns_of(&Iteration::row, rows)});
}

ResultColumns<Iteration> indicator_columns() {
  ResultColumns<IterationRow> rows = iteration_columns();
  std::erase_if(rows, [](const auto& column) { return column.heading.name == "seconds"; });  // differ from run to run
  return with_solver(rows);
}

// For contact solvers, which have no zeta and no Z.
ResultColumns<Iteration> solver_indicator_columns() {
  constexpr std::array kept{"step", "iteration", "sweeps", "natural_map", "active", "stick", "slide", "status_changes"};
  ResultColumns<IterationRow> rows = iteration_columns();
  std::erase_if(rows, [&](const auto& column) { return std::ranges::find(kept, column.heading.name) == kept.end(); });
  rows.push_back({"factorisations", "1", "matrices factorised so far", &IterationRow::factorisations});
  rows.push_back({"interface_iterations", "1", "solves of Stage 2 so far, in all linear systems that are cut",
                  &IterationRow::interface_iterations});
  return with_solver(rows);
}

Index iterations(const ObservedCase& work, Index step, const Sink<Iteration>& sink) {
  const Simulation simulation = simulation_at(work, step - 1);
  std::vector<IterationRow> rows;
  const StepReport solved = solved_report(simulation, {[&](const IterationRow& row) { rows.push_back(row); }});
  const SolvedCase solver{work.one.spec.name, simulation, solved};
  // The first iterations, then about forty per decade: enough for a logarithmic axis.
  for (const IterationRow& row : rows)
    if (const Index i = row.record.iteration; i <= 20 || begins_interval(i, 40) || &row == &rows.back())
      sink({solver, row});
  return 0;
}

// A run with the solver of the case, compared with plain Gauss-Seidel (LeadInSolver::plain).
struct WholeRun {
  SolvedCase solver;
  Index steps = 0;
  RunTotals totals;
  double distance_mean = 0, distance_maximum = 0;  // of the free grains from those of plain Gauss-Seidel, m
};

ResultColumns<WholeRun> run_columns() {
  using Totals = RunTotals;
  const ResultColumns<Totals> totals{
      {"converged_steps", "1", "of them those that converged", &Totals::converged},
      {"iterations", "1", "of all steps", &Totals::iterations},
      {"natural_map", "1", "|natural map| / max(|r|, |r^1|) of the velocities kept, the worst of all steps",
       &Totals::natural_map},
      {"gluing", "1", "jump at the interface at the last iteration, the largest of all steps", &Totals::gluing},
      {"kinetic", "J", "energy of the free grains at the end", [](const Totals& t) { return t.last.energy.kinetic; }}};
  return joined<WholeRun>({columns_of(&WholeRun::solver, solver_columns()),
                           {{"steps", "1", "steps of the run", &WholeRun::steps}},
                           columns_of(&WholeRun::totals, totals),
                           {{"distance_mean", "m", "of the free grains at the end from those of plain Gauss-Seidel",
                             &WholeRun::distance_mean},
                            {"distance_maximum", "m", "the largest of these distances", &WholeRun::distance_maximum}}});
}

Index whole_run(const ObservedCase& work, Index steps, const Sink<WholeRun>& sink) {
  const Arrival own = work.lead_in.at(work.one, steps, LeadInSolver::own);
  const GranularState plain = work.lead_in.at(work.one, steps, LeadInSolver::plain).simulation.state;
  const GranularSystem& system = own.simulation.system;
  const GranularState& state = own.simulation.state;
  WholeRun run{{work.one.spec.name, own.simulation, own.totals.last}, steps, own.totals};
  for (Index i = 0; i < system.grains(); ++i) {
    if (!system.free(i)) continue;
    const double distance = system.length(system.apart(centre_of(plain, at(i)), centre_of(state, at(i))));
    run.distance_mean += distance / static_cast<double>(system.free_grains());
    run.distance_maximum = std::max(run.distance_maximum, distance);
  }
  sink(run);
  return 0;
}

}  // namespace

constinit const Observable observables::configuration = at_steps<grain_columns, placed_grains>(
    {.name = "configuration",
     .summary = "grains of a case that moves after some steps, with their subdomains",
     .first_step = 0});

constinit const Observable observables::force_chains =
    at_steps<chain_columns, chains>({.name = "force_chains",
                                     .summary = "contacts with their impulses of a case that moves after some steps",
                                     .first_step = 0});

constinit const Observable observables::indicators = at_steps<indicator_columns, iterations>(
    {.name = "indicators", .summary = "indicators of every iteration of a step of a case that moves"});

constinit const Observable observables::solver_indicators = at_steps<solver_indicator_columns, iterations>(
    {.name = "solver_indicators",
     .summary = "residual and work of every check of a contact solver in a step of a case that moves",
     .check = [](const CaseSpec& spec) {
       if (!is_contact_solver(spec.dynamics->solver.algorithm))
         fail("solver.algorithm: expected a contact solver, met {}", to_string(spec.dynamics->solver.algorithm));
     }});

constinit const Observable observables::runs = at_steps<run_columns, whole_run>(
    {.name = "runs",
     .summary = "runs of a case that moves with its own solver: iterations, residuals, distance from Gauss-Seidel",
     .rows = row_per_step,
     .known = known_step,
     .first_step = 0,
     .own_solver = true});

}  // namespace nscdd
