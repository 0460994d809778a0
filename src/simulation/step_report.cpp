// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/step_report.hpp"

namespace nscdd {
namespace {

// Indicators of both tables, of a result with an IterationRecord `record` and a residual.
template <class Result>
ResultColumns<Result> indicators(IterationRecord Result::*record) {
  using Record = IterationRecord;
  using Residual = ContactResidual;
  const ResultColumns<Record> of_iteration{
      {"sweeps", "1", "Gauss-Seidel sweeps of a subdomain so far in the step", &Record::sweeps},
      {"zeta", "1", "|r_i - r_i-1| / |r_i| over all contacts, [ADI12] eq. (39)", &Record::zeta},
      {"interface_change", "1", "Z = |F_i - F_i-1| / |F_i| over the interface, [ADI12] eq. (40)",
       &Record::interface_change},
      {"gluing", "1", "|sum A_E V_E| / max(|V_free|, |V|) over the copies of shared grains, after Stage 1",
       &Record::gluing},
      {"normal_change", "1",
       "sum |r_n,i - r_n,i-1| / sum |r_n,i| over all contacts, as the program of [ADI12] has it; nan if not measured",
       &Record::normal_change}};
  const ResultColumns<Residual> of_law{
      {"natural_map", "1", "|natural map| / max(|r|, |r^1|), error of the contact law",
       &Residual::relative_natural_map},
      {"quad_dv", "1", "LMGC90's criterion Quad/DV", &Residual::quad_dv},
      {"quad_dvr", "1", "LMGC90's criterion Quad/DVR", &Residual::quad_dvr},
      {"mean_dv_over_r", "1", "LMGC90's criterion mean DV over r", &Residual::mean_dv_over_r},
      {"qm_16", "1", "LMGC90's criterion QM/16, the largest of these three and of Maxm/DV and Maxm/DVR over 16.666",
       &Residual::qm_16},
      {"active", "1", "contacts with an impulse", &Residual::active},
      {"stick", "1", "contacts that stick", &Residual::stick},
      {"slide", "1", "contacts that slide", &Residual::slide}};
  return joined<Result>({columns_of(record, of_iteration), columns_of(&Result::residual, of_law)});
}

// Iterations without progress after which rounding or cycling keeps the criterion from falling, if they are four times
// as many as led there: self-stresses may drift for thousands of iterations until a contact opens.
constexpr Index patience = 10000;
constexpr double explosion = 1e6;

// If F did not change (there is no interface, or Stage 2 leaves F) or nothing jumps, zeta replaces these two criteria:
// they cannot tell that the iterations ended.
double criterion_value(Criterion criterion, const IterationRecord& record, const ContactResidual& residual) {
  const std::array values{record.zeta,
                          record.interface_change == 0 ? record.zeta : record.interface_change,
                          record.gluing == 0 ? record.zeta : record.gluing,
                          residual.relative_natural_map(),
                          residual.quad_dv(),
                          residual.quad_dvr(),
                          std::abs(residual.mean_dv_over_r()),
                          residual.qm_16(),
                          record.normal_change,
                          infinity};  // as many iterations as allowed
  return values[static_cast<std::size_t>(criterion)];
}

}  // namespace

bool begins_interval(Index iteration, Index per_decade) {
  const auto interval = [&](Index i) {
    return std::floor(static_cast<double>(per_decade) * std::log10(static_cast<double>(i)));
  };
  return iteration <= 1 || interval(iteration) != interval(iteration - 1);
}

bool IterationSink::observes(Index iteration) const {
  if (!row) return false;
  return every > 0 ? iteration % every == 0 : begins_interval(iteration, 10);
}

double StepReport::driven_residual() const {
  return residual.natural_map == 0 ? 0.0 : std::sqrt(residual.natural_map) / residual.scale.driving();
}

const ResultColumns<IterationRow>& iteration_columns() {
  using Iteration = IterationRow;
  static const auto columns = joined<Iteration>(
      {{{"step", "1", "time step, from 1", &Iteration::step},
        {"iteration", "1", "iteration of the step, from 1", [](const Iteration& row) { return row.record.iteration; }}},
       indicators(&Iteration::record),
       {{"status_changes", "1", "contacts whose status differs from that at the iteration observed before",
         &Iteration::status_changes},
        {"seconds", "s", "time of the iterations of the step so far, without the indicators", &Iteration::seconds}}});
  return columns;
}

const ResultColumns<StepReport>& step_columns() {
  using Step = StepReport;
  using Energy = StepEnergy;
  static const ResultColumns<Energy> energy{
      {"kinetic", "J", "energy of the free grains at the end of the step", &Energy::kinetic},
      {"potential", "J", "energy of the free grains in gravity at the end of the step", &Energy::potential},
      {"boundary_work", "J", "done by boundaries in the step", &Energy::boundary_work},
      {"dissipation", "J", "in contacts in the step", &Energy::dissipation},
      {"numerical", "J", "change of energy that neither accounts for", &Energy::numerical}};
  static const auto columns = joined<Step>(
      {{{"step", "1", "time step, from 1", &Step::step},
        {"time", "s", "at the end of the step", &Step::time},
        {"status", "", "how the iterations ended", &Step::status},
        {"iterations", "1", "of the step", [](const Step& step) { return step.last.iteration; }}},
       indicators(&Step::last),
       {{"impulses", "N s", "|r| over all contacts", [](const Step& step) { return std::sqrt(step.last.impulses); }},
        {"driving", "N s",
         "max(|r^1|, p), what drives the contacts of the step; r^1: impulse of each contact as if it were the only one",
         [](const Step& step) { return step.residual.scale.driving(); }},
        {"driven_residual", "1", "|natural map| over `driving`, which does not fall as impulses grow",
         &Step::driven_residual},
        {"no_room", "1", "1 if contacts keep closing although impulses grew: boundaries may leave no room; else 0",
         [](const Step& step) { return Index{step.no_room}; }},
        {"verdict", "", "whether the step has a solution: exists, impossible or undecided; none if not asked for",
         [](const Step& step) { return step.verdict ? to_string(*step.verdict) : std::string_view("none"); }},
        {"margin", "m/s", "largest s found with u_n - mu |u_t| >= s at every contact; nan without a verdict",
         &Step::margin},
        {"closing_speed", "m/s", "at which driven bodies close on the contacts that jam; nan if none are known to",
         &Step::closing_speed},
        {"contacts", "1", "considered in the step", &Step::contacts},
        {"interface_size", "1", "n_Gamma, 3 per gluing, in space 6", &Step::interface_size},
        {"overlap_maximum", "m", "largest overlap when contacts are found",
         [](const Step& step) { return step.overlap.maximum; }},
        {"overlap_mean", "m", "mean over the contacts that overlap then",
         [](const Step& step) { return step.overlap.mean; }}},
       columns_of(&Step::energy, energy),
       {{"mean_speed", "m/s", "sqrt(2 kinetic / mass of the free bodies), what dynamics.rest_speed bounds",
         &Step::mean_speed},
        {"eta", "1/kg", "flexibility of the enriched Stage 2; nan for the other algorithms", &Step::eta},
        {"eta_relative", "1", "eta in multiples of mean_w_nn", [](const Step& step) { return step.eta / step.scale; }},
        {"mean_w_nn", "1/kg", "W, mean of W_nn over the contacts considered; 0 without contacts", &Step::scale},
        {"factorisations", "1", "matrices factorised by contact solvers; one cut into subdomains counts once",
         &Step::factorisations},
        {"interface_systems", "1", "systems solved at the interface by the two-stage Newton method",
         &Step::interface_systems},
        {"interface_iterations", "1", "at the interface in all of them", &Step::interface_iterations},
        {"setup_seconds", "s", "finding contacts, decomposing, factorising", &Step::setup_seconds},
        {"solve_seconds", "s", "iterations, without the indicators", &Step::solve_seconds}}});
  return columns;
}

Index changes_of(std::vector<ContactStatus>& statuses, std::vector<ContactStatus> now) {
  statuses.resize(now.size(), ContactStatus::open);
  Index changes = 0;
  for (std::size_t k = 0; k < now.size(); ++k) changes += statuses[k] != now[k];
  statuses = std::move(now);
  return changes;
}

bool IterationWatch::needs_residual() const {
  using enum Criterion;
  constexpr std::array of_law{natural_map, quad_dv, quad_dvr, mean_dv_over_r, qm_16};
  return std::ranges::count(of_law, Criterion(solver_.criterion)) > 0;
}

IterationWatch::IterationWatch(const StepSolver& solver)
    : solver_(solver),
      watch_({.tolerance = solver.tolerance,
              .growth = explosion * explosion,  // of squares
              .patience = patience,
              .longer = 4},
             SolverStatus::no_number) {}

std::optional<SolverStatus> IterationWatch::judge(const IterationRecord& record, const ContactResidual& residual) {
  const double value = criterion_value(solver_.criterion, record, residual);
  if (++judged_ <= 10) first_impulses_ = std::max(first_impulses_, record.impulses);
  // Contacts may have settled within subdomains while their copies of shared grains still differ.
  const bool glued = record.gluing <= solver_.gluing_tolerance || semi_implicit(solver_);
  const auto status = watch_.judge(record.iteration, std::isfinite(record.gluing) ? value : not_a_number,
                                   record.impulses, first_impulses_, glued);
  const bool goes_on = !status || *status == SolverStatus::stalled;
  return goes_on && record.iteration >= solver_.maximum_iterations ? SolverStatus::maximum_reached : status;
}

}  // namespace nscdd
