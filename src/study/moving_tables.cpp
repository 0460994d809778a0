// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/moving_tables.hpp"

#include "study/predicted_observed.hpp"
#include "study/simulation_tables.hpp"

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

std::vector<Column> solver_columns() {
  return {{"case", "", "name of the case"},
          {"grains", "1", "free disks"},
          {"algorithm", "", "nlgs, generic or enriched"},
          {"gauss_seidel_sweeps", "1", "n_GS, sweeps of Stage 1 per iteration"},
          {"eta", "1/kg", "flexibility of the enriched Stage 2; inf for the generic one"},
          {"interface_dofs", "1", "interface unknowns n_Gamma"}};
}

Row solver_cells(const Case& one, const Simulation& simulation, double eta, Index interface_size) {
  const StepSolver& solver = simulation.dynamics.solver;
  return {one.name,
          std::int64_t{simulation.system.free_disks()},
          solver.algorithm,
          std::int64_t{solver.gauss_seidel_sweeps},
          solver.algorithm == "enriched" ? eta : infinity,
          std::int64_t{interface_size}};
}

// The row of an iteration without its time, which differs from run to run.
std::vector<Column> timeless_columns() {
  std::vector<Column> columns = iteration_columns();
  std::erase_if(columns, [](const Column& column) { return column.name == "seconds"; });
  return columns;
}

Row timeless(const Row& row) {
  const std::vector<Column> columns = iteration_columns();
  Row result;
  for (std::size_t k = 0; k < row.size(); ++k)
    if (columns[k].name != "seconds") result.push_back(row[k]);
  return result;
}

// Subdomains that hold each disk after a fresh decomposition of the present step, and the lowest of them.
struct Membership {
  std::vector<Index> first, multiplicity;
};

Membership membership(const SolvedStep& step, Index disks) {
  Membership result{std::vector<Index>(at(disks), -1), std::vector<Index>(at(disks), 0)};
  std::vector<std::vector<Index>> of_disk(at(disks));
  for (std::size_t k = 0; k < step.problem.geometry.size(); ++k)
    for (const Index i : {step.problem.geometry[k].a, step.problem.geometry[k].b})
      if (i < disks) of_disk[at(i)].push_back(step.partition.subdomain_of_contact[k]);
  for (std::size_t i = 0; i < of_disk.size(); ++i) {
    auto& all = of_disk[i];
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    result.multiplicity[i] = count(all);
    if (!all.empty()) result.first[i] = all.front();
  }
  return result;
}

// All of the first iterations, then about forty per decade: what a logarithmic axis can show.
bool shown(Index iteration) {
  const auto place = [](Index i) { return std::floor(40 * std::log10(static_cast<double>(i))); };
  return iteration <= 20 || place(iteration) != place(iteration - 1);
}

}  // namespace

std::vector<Column> indicator_columns() {
  std::vector<Column> columns = solver_columns();
  const std::vector<Column> more = timeless_columns();
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

void indicator_rows(const Case& one, Place before, LeadIn& lead_in, const RowSink& sink) {
  const Simulation simulation = lead_in.at(one, before.steps, before.solver).simulation;
  std::vector<IterationRow> rows;
  const SolvedStep solved = solve_step(simulation, [&](const IterationRow& row) { rows.push_back(row); });
  const Row cells = solver_cells(one, simulation, solved.report.eta, solved.report.interface_size);
  for (const IterationRow& row : rows) {
    if (!shown(row.record.iteration) && &row != &rows.back()) continue;
    Row full = cells;
    const Row more = timeless(iteration_row(row));
    full.insert(full.end(), more.begin(), more.end());
    sink(full);
  }
}

std::vector<Column> configuration_columns() {
  return {{"case", "", "name of the case"},
          {"step", "1", "steps done"},
          {"disk", "1", "number of the disk, grains first"},
          {"x", "m", "centre"},
          {"y", "m", "centre"},
          {"radius", "m", "radius"},
          {"angle", "rad", "angle turned by"},
          {"driven", "", "whether a boundary drives it"},
          {"subdomain", "1", "lowest subdomain that holds it; -1 for a disk without contact"},
          {"multiplicity", "1", "subdomains that hold it"}};
}

void configuration_rows(const Case& one, Place place, LeadIn& lead_in, const RowSink& sink) {
  const Simulation simulation = lead_in.at(one, place.steps, place.solver).simulation;
  const GranularState& state = simulation.state;
  const Membership of = membership(next_step(simulation, place.solver), simulation.system.disks());
  for (Index i = 0; i < simulation.system.disks(); ++i)
    sink({one.name, std::int64_t{place.steps}, std::int64_t{i}, state.x[at(i)], state.y[at(i)],
          simulation.system.radius[at(i)], state.angle[at(i)], !simulation.system.free(i),
          std::int64_t{of.first[at(i)]}, std::int64_t{of.multiplicity[at(i)]}});
}

std::vector<Column> chain_columns() {
  return {{"case", "", "name of the case"},
          {"step", "1", "steps done before the one whose impulses these are"},
          {"x_a", "m", "centre of one disk"},
          {"y_a", "m", "centre of one disk"},
          {"x_b", "m", "centre of the other, or foot on a wall"},
          {"y_b", "m", "centre of the other, or foot on a wall"},
          {"impulse_n", "N s", "normal impulse"},
          {"impulse_t", "N s", "tangential impulse"},
          {"status", "", "stick, slide_forward or slide_backward"},
          {"subdomain", "1", "subdomain of the contact"}};
}

void chain_rows(const Case& one, Place place, LeadIn& lead_in, const RowSink& sink) {
  const Simulation simulation = lead_in.at(one, place.steps, place.solver).simulation;
  const SolvedStep step = next_step(simulation, place.solver);
  const ContactLaw law = contact_law(simulation.dynamics.interaction, step.problem.h);
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const DiskContact& c = step.contacts[k];
    const StepContact& g = step.problem.geometry[k];
    if (c.impulse_n == 0 && c.impulse_t == 0) continue;
    const bool wall = g.b >= simulation.system.disks();
    const auto a = at(g.a), b = at(g.b);
    sink({one.name, std::int64_t{place.steps}, simulation.state.x[a], simulation.state.y[a],
          wall ? g.point[0] : simulation.state.x[b], wall ? g.point[1] : simulation.state.y[b], c.impulse_n,
          c.impulse_t, std::string(to_string(status_of(law, c))),
          std::int64_t{step.partition.subdomain_of_contact[k]}});
  }
}

std::vector<Column> run_columns() {
  std::vector<Column> columns = solver_columns();
  const std::vector<Column> more{
      {"steps", "1", "steps of the run"},
      {"converged_steps", "1", "of them those that converged"},
      {"iterations", "1", "of all steps"},
      {"natural_map", "1", "|natural map| / |r| of the velocities kept, the worst of all steps"},
      {"gluing", "1", "jump at the interface at the last iteration, the largest of all steps"},
      {"kinetic", "J", "energy of the free disks at the end"},
      {"distance_mean", "m", "of the free disks at the end from those of plain Gauss-Seidel"},
      {"distance_maximum", "m", "the largest of these distances"}};
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

void run_row(const Case& one, Index steps, LeadIn& lead_in, const RowSink& sink) {
  const Arrival own = lead_in.at(one, steps, LeadInSolver::own);
  const GranularState plain = lead_in.at(one, steps, LeadInSolver::plain).simulation.state;
  const GranularSystem& system = own.simulation.system;
  const GranularState& state = own.simulation.state;
  double mean = 0, maximum = 0;
  for (Index i = 0; i < system.disks(); ++i) {
    if (!system.free(i)) continue;
    const double distance = std::hypot(state.x[at(i)] - plain.x[at(i)], state.y[at(i)] - plain.y[at(i)]);
    mean += distance / static_cast<double>(system.free_disks());
    maximum = std::max(maximum, distance);
  }
  const RunTotals& totals = own.totals;
  Row row = solver_cells(one, own.simulation, totals.eta, totals.interface_size);
  const Row more{std::int64_t{steps},
                 std::int64_t{totals.converged},
                 std::int64_t{totals.iterations},
                 totals.natural_map,
                 totals.gluing,
                 totals.kinetic,
                 mean,
                 maximum};
  row.insert(row.end(), more.begin(), more.end());
  sink(row);
}

std::vector<Column> predicted_observed_columns() {
  std::vector<Column> columns = solver_columns();
  const std::vector<Column> more{
      {"step", "1", "step examined, from 1"},
      {"active", "1", "contacts with an impulse at the statuses compared"},
      {"stick", "1", "of them sticking"},
      {"slide", "1", "of them sliding"},
      {"predicted", "1", "spectral radius of the frozen iteration with n_GS sweeps"},
      {"predicted_exact", "1", "the same with an exact Stage 1; nan for large packings"},
      {"complex_pair", "", "whether the dominant eigenvalue is one of a complex pair"},
      {"observed", "1",
       "rate fitted to the run; nan where no stretch of fixed statuses falls or grows enough, at one rate"},
      {"observed_error", "1", "standard error of the fit, and what the rate drifts by along it"},
      {"relative_gap", "1", "|observed - predicted| / (1 - predicted)"},
      {"agree", "", "whether that is at most 1 %, or the rates differ by at most three errors of the fit"},
      {"rate_z", "1", "rate fitted to Z itself over the same iterations"},
      {"first_iteration", "1", "first iteration fitted"},
      {"last_iteration", "1", "last iteration fitted"},
      {"iterations", "1", "iterations run"},
      {"status", "", "how the run ended"},
      {"converged", "", "whether prediction and observation are both known"}};
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

bool predicted_observed_row(const Case& one, Place before, LeadIn& lead_in, const RowSink& sink) {
  const Simulation simulation = lead_in.at(one, before.steps, before.solver).simulation;
  const PredictedObserved result = predicted_observed(simulation);
  const bool known = result.converged && result.observed == result.observed;
  Row row = solver_cells(one, simulation, result.eta, result.interface_size);
  const Row more{std::int64_t{before.steps + 1},
                 std::int64_t{result.active},
                 std::int64_t{result.stick},
                 std::int64_t{result.slide},
                 result.predicted,
                 result.predicted_exact,
                 result.complex_pair,
                 result.observed,
                 result.observed_error,
                 result.relative_gap(),
                 result.agree(),
                 result.rate_z,
                 std::int64_t{result.first},
                 std::int64_t{result.last},
                 std::int64_t{result.iterations},
                 std::string(to_string(result.status)),
                 known};
  row.insert(row.end(), more.begin(), more.end());
  sink(row);
  return known;
}

}  // namespace nscdd
