// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/study/optimum.hpp>

namespace nscdd {

Optimum optimum(const Model& model, const OptimumParameters& parameters) {
  const Selection selection = select(model, parameters.contacts);
  Optimum best = optimum(model.parts, selection.stage_one, parameters.epsilon, parameters.spectral);
  if (!selection.certain && best.status != OptimumStatus::no_interface)
    best.status = OptimumStatus::not_converged;
  return best;
}

std::vector<Column> optimum_columns() {
  std::vector<Column> columns = case_columns();
  const std::vector<Column> more{
      {"epsilon", "1/kg", "flexibility of the linear law, 0 for the rigid limit"},
      {"unit_multiplicity", "1", "multiplicity of the eigenvalue 1, left out of every radius of this table"},
      {"generic_radius", "1", "radius of the generic algorithm"},
      {"status", "", "interior, eta_to_zero, no_interface, already_exact or not_converged"},
      {"best_eta", "1/kg", "flexibility of the smallest radius"},
      {"best_radius", "1", "the smallest radius of the enriched algorithm"},
      {"convergent_from", "1/kg", "the enriched algorithm converges for every eta above this; 0 for all"},
      {"better_from", "1/kg", "it beats the generic one for every eta above this; 0 for all"},
      {"generic_relaxation", "1", "best relaxation of the generic algorithm"},
      {"generic_relaxed_radius", "1", "its radius with that relaxation"},
      {"relaxed_status", "", "interior, eta_to_zero or eta_to_infinity"},
      {"relaxed_best_eta", "1/kg", "flexibility of the smallest radius with relaxation"},
      {"relaxed_best_relaxation", "1", "relaxation there"},
      {"relaxed_best_radius", "1", "radius there"},
      {"residual", "1", "largest residual of the spectra at the flexibilities of this row"},
      {"spectra", "1", "spectra computed"}};
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

Row optimum_row(const Model& model, const OptimumParameters& parameters, const Optimum& best) {
  Row row = case_cells(model, select(model, parameters.contacts), parameters.contacts);
  const Row more{parameters.epsilon,
                 std::int64_t{best.unit_multiplicity},
                 best.generic_radius,
                 std::string(to_string(best.status)),
                 best.eta,
                 best.radius,
                 best.convergent_from,
                 best.better_from,
                 best.generic_relaxation,
                 best.generic_relaxed_radius,
                 std::string(to_string(best.relaxed_status)),
                 best.relaxed_eta,
                 best.relaxation,
                 best.relaxed_radius,
                 best.residual,
                 std::int64_t{best.spectra}};
  row.insert(row.end(), more.begin(), more.end());
  return row;
}

Index optima(const Model& model, const SweepParameters& sweep, const RowSink& sink, const Monitor& monitor,
             Index first) {
  Index failed = 0;
  const Index total = count(sweep.epsilon);
  for (Index i = first; i < total; ++i) {
    const OptimumParameters parameters{sweep.epsilon[at(i)], sweep.contacts, sweep.spectral};
    const Optimum best = optimum(model, parameters);
    failed += best.status == OptimumStatus::not_converged;
    sink(optimum_row(model, parameters, best));
    if (!report(monitor, i + 1, total)) break;
  }
  return failed;
}

}  // namespace nscdd
