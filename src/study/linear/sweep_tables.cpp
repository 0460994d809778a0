// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/sweep_points.hpp"
#include "study/tables/study.hpp"

namespace nscdd {
namespace {

// The eigenvalues in the certified interval or, without one, those found that agree with the first.
Index multiplicity(const std::vector<double>& values, Index within, double tolerance) {
  if (within > 0) return within;
  return std::count_if(values.begin(), values.end(), [&](double mu) { return std::abs(mu - values[0]) <= tolerance; });
}

// Columns of certificates and further eigenvalues.
ResultColumns<SpectralRadius> end_columns(const SpectralOptions& options) {
  using Radius = SpectralRadius;
  ResultColumns<Radius> columns;
  if (options.certify)
    columns = {
        {"certified", "", "inertia counts prove that no eigenvalue lies outside the two intervals", &Radius::certified},
        {"low_from", "1", "interval that holds the low end of the spectrum (unit eigenvalues apart)",
         [](const Radius& r) { return r.interval_min[0]; }},
        {"low_to", "1", "its upper bound", [](const Radius& r) { return r.interval_min[1]; }},
        {"high_from", "1", "interval that holds the high end of the spectrum (unit eigenvalues apart)",
         [](const Radius& r) { return r.interval_max[0]; }},
        {"high_to", "1", "its upper bound", [](const Radius& r) { return r.interval_max[1]; }}};
  const auto end = [&](const char* name, std::vector<double> Radius::*values, Index Radius::*within) {
    columns.push_back({fmt::format("{}_multiplicity", name), "1",
                       fmt::format("eigenvalues within the interval (else: found) at the {} end", name),
                       [=, tolerance = options.tolerance](const Radius& r) {
                         return multiplicity(r.*values, r.*within, tolerance);
                       }});
  };
  const auto list = [&](const char* name, std::vector<double> Radius::*values) {
    for (Index k = 1; k <= options.eigenvalues; ++k)
      columns.push_back(
          {fmt::format("eigenvalue_{}_{}", name, k), "1",
           fmt::format("number {} from the {} end, unit eigenvalues apart", k, name),
           [=](const Radius& r) { return k <= count(r.*values) ? (r.*values)[at(k - 1)] : not_a_number; }});
  };
  if (options.certify || options.eigenvalues > 1) {
    end("low", &Radius::low, &Radius::within_min);
    end("high", &Radius::high, &Radius::within_max);
  }
  if (options.eigenvalues > 1) {
    list("low", &Radius::low);
    list("high", &Radius::high);
  }
  return columns;
}

}  // namespace

ResultColumns<SweepPoint> point_columns() {
  return {{"epsilon", "1/kg", "flexibility of the linear law, 0 for the rigid limit", &SweepPoint::epsilon},
          {"eta", "1/kg", "flexibility of the network of Stage 2, inf for the generic algorithm", &SweepPoint::eta},
          {"relaxation", "1", "omega of F <- F + omega (F' - F)",
           [](const SweepPoint& p) { return p.relaxation.value_or(not_a_number); }},
          {"gauss_seidel_sweeps", "1", "sweeps n_GS of Stage 1, inf where it is exact", [](const SweepPoint& p) {
             return p.gauss_seidel_sweeps ? static_cast<double>(*p.gauss_seidel_sweeps) : infinity;
           }}};
}

ResultColumns<CaseSummary> case_columns() {
  return {{"case", "", "name of the case", &CaseSummary::name},
          {"grains", "1", "grains of the packing", &CaseSummary::grains},
          {"contacts", "1", "contacts of the packing", &CaseSummary::contacts},
          {"active_contacts", "1", "contacts of Stage 1", &CaseSummary::active_contacts},
          {"subdomains", "1", "subdomains of the partition, empty ones included", &CaseSummary::subdomains},
          {"interface_dofs", "1", "interface unknowns n_Gamma", &CaseSummary::interface_size},
          {"contact_set", "", "all (H_E), or active, unilateral or frozen (G_E) in Stage 1", &CaseSummary::contact_set},
          {"contact_rule", "", "how the contacts of Stage 1 were chosen", &CaseSummary::rule}};
}

ResultColumns<SweepResult> place_columns() {
  return joined<SweepResult>(
      {columns_of(&SweepResult::of_case, case_columns()), columns_of(&SweepResult::point, point_columns())});
}

ResultColumns<SweepResult> asked_columns(const SweepParameters& parameters) {
  ResultColumns<SweepResult> columns;
  if (parameters.schwarz())
    columns.push_back({"scheme", "", "schwarz; a table of nscdd lacks the column",
                       [](const SweepResult&) { return DecompositionScheme::schwarz; }});
  if (!parameters.relative_epsilon && !parameters.relative_eta) return columns;
  columns.push_back({"mean_w_nn", "1/kg", "mean of W_nn over the contacts", &SweepResult::scale});
  if (parameters.relative_epsilon)
    columns.push_back({"epsilon_relative", "1", "epsilon in multiples of mean_w_nn",
                       [](const SweepResult& result) { return result.asked.epsilon; }});
  if (parameters.relative_eta)
    columns.push_back({"eta_relative", "1", "eta in multiples of mean_w_nn",
                       [](const SweepResult& result) { return result.asked.eta; }});
  return columns;
}

ResultColumns<SweepResult> sweep_columns(const SweepParameters& parameters) {
  using Radius = SpectralRadius;
  static const ResultColumns<Radius> moduli{
      {"spectral_radius", "1", "largest modulus of the eigenvalues of the contraction operator", &Radius::value},
      {"eigenvalue_min", "1", "smallest eigenvalue (exact Stage 1 only, else nan)", &Radius::eigenvalue_min},
      {"eigenvalue_max", "1", "largest eigenvalue (exact Stage 1 only, else nan)", &Radius::eigenvalue_max},
      {"unit_multiplicity", "1", "multiplicity of the eigenvalue 1 in the rigid limit", &Radius::unit_multiplicity},
      {"subdominant_radius", "1", "largest modulus among the other eigenvalues", &Radius::subdominant}};
  static const ResultColumns<SweepResult> dominant{
      {"dominant_real", "1", "real part of the eigenvalue of largest modulus",
       [](const SweepResult& result) { return result.dominant.real(); }},
      {"dominant_imaginary", "1", "its imaginary part, of a pair the positive one",
       [](const SweepResult& result) { return result.dominant.imag(); }}};
  static const ResultColumns<Radius> certificate{
      {"solver", "",
       "dense, arpack, shift-invert, slepc, or none for an empty interface; if the row did not converge, why each "
       "solver failed",
       [](const Radius& radius) {
         return radius.converged || radius.failure.empty() ? radius.solver : radius.failure;
       }},
      {"applications", "1", "operator applications, 0 where matrices were assembled", &Radius::applications},
      {"residual", "1", "an eigenvalue lies within this of each end printed (a plain residual for inexact Stage 1)",
       &Radius::residual},
      {"converged", "1", "the solver converged and the residual is within the tolerance", &Radius::converged}};
  return joined<SweepResult>({place_columns(), columns_of(&SweepResult::radius, moduli), dominant,
                              columns_of(&SweepResult::radius, certificate),
                              columns_of(&SweepResult::radius, end_columns(parameters.spectral)),
                              asked_columns(parameters)});
}

KnownCells known_of_point(const StudyTable& table, Index number) {
  const SweepPoint point = sweep_point(table.sweep, number);
  KnownCells cells;
  for (const auto& [heading, value] : point_columns()) {
    const bool relative = (heading.name == "epsilon" && table.sweep.relative_epsilon) ||
                          (heading.name == "eta" && table.sweep.relative_eta);
    if (point.relaxation || heading.name != "relaxation")  // the optimal one follows from the spectrum
      cells.emplace_back(heading.name + (relative ? "_relative" : ""), value(point));
  }
  return cells;
}

constinit const Observable observables::spectral_radius{
    .name = "spectral_radius",
    .summary = "spectral radius of the contraction operator at every point of a sweep",
    .keys = {"epsilon", "eta", "relaxation", "gauss_seidel_sweeps", "contacts", "solver", "certify", "scheme"},
    .columns = [](const StudyTable& table) { return headings(sweep_columns(table.sweep)); },
    .run =
        [](const ObservedCase& work) {
          const SweepParameters& parameters = work.table.sweep;
          return sweep(built_for(parameters, work.one), parameters, as_rows(sweep_columns(parameters), work.sink),
                       work.monitor, work.first);
        },
    .rows = [](const StudyTable& table) { return point_count(table.sweep); },
    .known = known_of_point};

}  // namespace nscdd
