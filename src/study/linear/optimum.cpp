// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/optimum.hpp"

#include "study/linear/sweep_points.hpp"
#include "study/tables/study.hpp"

namespace nscdd {
namespace {

ResultColumns<OptimumResult> relaxation_columns() {
  using One = OptimumResult;
  const auto of = [](auto member) { return [member](const One& r) { return r.best.*member; }; };
  return joined<One>(
      {columns_of(&One::of_case, case_columns()),
       {{"epsilon", "1/kg", "flexibility of the linear law, 0 for the rigid limit", &One::epsilon},
        {"scheme", "", "schwarz", [](const One&) { return DecompositionScheme::schwarz; }},
        {"unit_multiplicity", "1", "multiplicity of the eigenvalue 1, left out of every radius of this table",
         of(&Optimum::unit_multiplicity)},
        {"radius", "1", "radius without relaxation", of(&Optimum::generic_radius)},
        {"status", "", "interior, no_interface, already_exact or not_converged", of(&Optimum::status)},
        {"convergent_below", "1", "the iteration converges for every relaxation below this",
         of(&Optimum::convergent_from)},
        {"best_relaxation", "1", "relaxation of the smallest radius", of(&Optimum::generic_relaxation)},
        {"best_radius", "1", "radius there", of(&Optimum::generic_relaxed_radius)},
        {"residual", "1", "of the spectrum", of(&Optimum::residual)}}});
}

// With the scheme schwarz; see optimum_columns.
Optimum best_relaxation(const Decomposition& stage_one, double epsilon, const SpectralOptions& options) {
  if (stage_one.interface_size() == 0) return {.status = OptimumStatus::no_interface};
  const SpectralRadius found = spectral_radius(schwarz_contraction(stage_one, LinearViscous{epsilon}), options);
  const double low = 1 - found.subdominant_max, high = 1 - found.subdominant_min;
  Optimum best{.unit_multiplicity = found.unit_multiplicity,
               .generic_radius = found.subdominant,
               .convergent_from = 2 / high,
               .generic_relaxed_radius = (high - low) / (high + low),
               .generic_relaxation = 2 / (high + low),
               .residual = found.residual,
               .spectra = 1,
               .failure = found.failure};
  if (!found.converged)
    best.status = OptimumStatus::not_converged;
  else if (!(found.subdominant > std::max(1e-14, found.residual)))
    best.status = OptimumStatus::already_exact;
  return best;
}

}  // namespace

ResultColumns<OptimumResult> optimum_columns(const SweepParameters& sweep) {
  static const ResultColumns<Optimum> best{
      {"unit_multiplicity", "1", "multiplicity of the eigenvalue 1, left out of every radius of this table",
       &Optimum::unit_multiplicity},
      {"generic_radius", "1", "radius of the generic algorithm", &Optimum::generic_radius},
      {"status", "", "interior, eta_to_zero, no_interface, already_exact, all_unit or not_converged", &Optimum::status},
      {"best_eta", "1/kg", "flexibility of the smallest radius", &Optimum::eta},
      {"best_radius", "1", "the smallest radius of the enriched algorithm", &Optimum::radius},
      {"convergent_from", "1/kg", "the enriched algorithm converges for every eta above this; 0 for all",
       &Optimum::convergent_from},
      {"better_from", "1/kg", "it beats the generic one for every eta above this; 0 for all", &Optimum::better_from},
      {"generic_relaxation", "1", "best relaxation of the generic algorithm", &Optimum::generic_relaxation},
      {"generic_relaxed_radius", "1", "its radius with that relaxation", &Optimum::generic_relaxed_radius},
      {"relaxed_status", "", "interior, eta_to_zero or eta_to_infinity", &Optimum::relaxed_status},
      {"relaxed_best_eta", "1/kg", "flexibility of the smallest radius with relaxation", &Optimum::relaxed_eta},
      {"relaxed_best_relaxation", "1", "relaxation there", &Optimum::relaxation},
      {"relaxed_best_radius", "1", "radius there", &Optimum::relaxed_radius},
      {"residual", "1", "largest residual of the spectra at the flexibilities of this row", &Optimum::residual},
      {"spectra", "1", "spectra computed", &Optimum::spectra}};
  static const auto columns = joined<OptimumResult>(
      {columns_of(&OptimumResult::of_case, case_columns()),
       {{"epsilon", "1/kg", "flexibility of the linear law, 0 for the rigid limit", &OptimumResult::epsilon}},
       columns_of(&OptimumResult::best, best)});
  static const ResultColumns<OptimumResult> in_multiples{
      {"mean_w_nn", "1/kg", "mean of W_nn over the contacts", &OptimumResult::scale},
      {"epsilon_relative", "1", "epsilon in multiples of mean_w_nn", &OptimumResult::relative_epsilon},
      {"best_eta_relative", "1", "best_eta in multiples of mean_w_nn",
       [](const OptimumResult& r) { return r.best.eta / r.scale; }},
      {"relaxed_best_eta_relative", "1", "relaxed_best_eta in multiples of mean_w_nn",
       [](const OptimumResult& r) { return r.best.relaxed_eta / r.scale; }}};
  ResultColumns<OptimumResult> all = sweep.schwarz() ? relaxation_columns() : columns;
  if (sweep.relative_epsilon)
    all.insert(all.end(), in_multiples.begin(), in_multiples.begin() + (sweep.schwarz() ? 2 : 4));
  return all;
}

Index optima(const Model& model, const Selection& selection, const SweepParameters& sweep,
             const Sink<OptimumResult>& sink, const Monitor& monitor, Index first) {
  const double scale = flexibility_scale(model);
  check_sweep(sweep);
  Index failed = 0;
  const Index total = count(sweep.epsilon);
  for (Index i = first; i < total; ++i) {
    const double asked = sweep.epsilon[at(i)], epsilon = sweep.relative_epsilon ? asked * scale : asked;
    OptimumResult result{selection.of_case, epsilon,
                         sweep.schwarz() ? best_relaxation(selection.stage_one(model), epsilon, sweep.spectral)
                                         : optimum(model.parts, selection.stage_one(model), epsilon, sweep.spectral),
                         sweep.relative_epsilon ? asked : epsilon / scale, scale};
    OptimumStatus& status = result.best.status;
    if (!selection.certain && status != OptimumStatus::no_interface) {
      status = OptimumStatus::not_converged;
      result.best.failure = uncertain_choice;
    }
    failed += status == OptimumStatus::not_converged;
    sink(result);
    if (!report(monitor, i + 1, total)) break;
  }
  return failed;
}

constinit const Observable observables::optimum{
    .name = "optimum",
    .summary = "best flexibility eta of the enriched algorithm, with and without relaxation",
    .keys = {"epsilon", "contacts", "solver", "certify", "scheme"},
    .columns = [](const StudyTable& table) { return headings(optimum_columns(table.sweep)); },
    .run =
        [](const ObservedCase& work) {
          const SweepParameters& sweep = work.table.sweep;
          const Model model = build(work.one);
          return optima(model, select(model, sweep.contacts), sweep, as_rows(optimum_columns(sweep), work.sink),
                        work.monitor, work.first);
        },
    .rows = [](const StudyTable& table) { return count(table.sweep.epsilon); },
    .known =
        [](const StudyTable& table, Index row) {
          return KnownCells{
              {table.sweep.relative_epsilon ? "epsilon_relative" : "epsilon", table.sweep.epsilon[at(row)]}};
        }};

}  // namespace nscdd
