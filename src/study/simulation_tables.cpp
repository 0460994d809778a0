// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/simulation_tables.hpp"

#include <cmath>

namespace nscdd {
namespace {

// Indicators that both tables have.
std::vector<Column> indicator_columns() {
  return {
      {"sweeps", "1", "Gauss-Seidel sweeps of a subdomain so far in the step"},
      {"zeta", "1", "|r_i - r_i-1| / |r_i| over all contacts, [ADI12] eq. (39)"},
      {"interface_change", "1", "Z = |F_i - F_i-1| / |F_i| over the interface, [ADI12] eq. (40)"},
      {"gluing", "1", "|sum A_E V_E| / max(|V_free|, |V|) over the copies of shared grains, after Stage 1"},
      {"natural_map", "1", "|natural map| / |r|, error of the contact law"},
      {"quad_dv", "1", "LMGC90's criterion Quad/DV"},
      {"mean_dv_over_r", "1", "LMGC90's criterion mean DV over r"},
      {"active", "1", "contacts with an impulse"},
      {"stick", "1", "contacts that stick"},
      {"slide", "1", "contacts that slide"}};
}

void append_indicators(Row& row, const IterationRecord& record, const ContactResidual& residual) {
  row.insert(row.end(),
             {std::int64_t{record.sweeps}, record.zeta, record.interface_change, record.gluing,
              residual.relative_natural_map(), residual.quad_dv(), residual.mean_dv_over_r(),
              std::int64_t{residual.active}, std::int64_t{residual.stick}, std::int64_t{residual.slide}});
}

void append(std::vector<Column>& columns, const std::vector<Column>& more) {
  columns.insert(columns.end(), more.begin(), more.end());
}

}  // namespace

std::vector<Column> iteration_columns() {
  std::vector<Column> columns{{"step", "1", "time step, from 1"},
                              {"iteration", "1", "iteration of the step, from 1"}};
  append(columns, indicator_columns());
  append(columns,
         {{"status_changes", "1", "contacts that open, stick or slide otherwise than an iteration before"},
          {"seconds", "s", "time of the iterations of the step so far, without the indicators"}});
  return columns;
}

Row iteration_row(const IterationRow& row) {
  Row cells{std::int64_t{row.step}, std::int64_t{row.record.iteration}};
  append_indicators(cells, row.record, row.residual);
  cells.emplace_back(std::int64_t{row.status_changes});
  cells.emplace_back(row.seconds);
  return cells;
}

std::vector<Column> step_columns() {
  std::vector<Column> columns{{"step", "1", "time step, from 1"},
                              {"time", "s", "at the end of the step"},
                              {"status", "", "how the iterations ended"},
                              {"iterations", "1", "of the step"}};
  append(columns, indicator_columns());
  append(columns, {{"impulses", "N s", "|r| over all contacts"},
                   {"contacts", "1", "considered in the step"},
                   {"interface_size", "1", "n_Gamma, 3 per gluing"},
                   {"overlap_maximum", "m", "largest overlap when contacts are found"},
                   {"overlap_mean", "m", "mean over the contacts that overlap then"},
                   {"kinetic", "J", "energy of the free grains at the end of the step"},
                   {"potential", "J", "energy of the free grains in gravity at the end of the step"},
                   {"boundary_work", "J", "done by boundaries in the step"},
                   {"dissipation", "J", "in contacts in the step"},
                   {"numerical", "J", "change of energy that neither accounts for"},
                   {"eta", "1/kg", "flexibility of the enriched Stage 2; nan for the other algorithms"},
                   {"setup_seconds", "s", "finding contacts, decomposing, factorising"},
                   {"solve_seconds", "s", "iterations, without the indicators"}});
  return columns;
}

Row step_row(const StepReport& report) {
  Row cells{std::int64_t{report.step}, report.time, std::string(to_string(report.status)),
            std::int64_t{report.last.iteration}};
  append_indicators(cells, report.last, report.residual);
  const StepEnergy& energy = report.energy;
  cells.insert(cells.end(), {std::sqrt(report.last.impulses), std::int64_t{report.contacts},
                             std::int64_t{report.interface_size}, report.overlap.maximum, report.overlap.mean,
                             energy.kinetic, energy.potential, energy.boundary_work, energy.dissipation,
                             energy.numerical, report.eta, report.setup_seconds, report.solve_seconds});
  return cells;
}

}  // namespace nscdd
