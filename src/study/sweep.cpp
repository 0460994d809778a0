// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/inexact_stage_one.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/study/study.hpp>

#include <fmt/format.h>

#include <cmath>

namespace nscdd {
namespace {

double optimal_relaxation(const SpectralRadius& plain) {
  // omega = 2 / (lambda_min + lambda_max) over the eigenvalues lambda = 1 - mu outside the kernel
  return 2.0 / (2.0 - plain.subdominant_min - plain.subdominant_max);
}

// Counts the eigenvalues in the certified interval or, without one, those found that agree with the first
// within the tolerance.
Index multiplicity(const std::vector<double>& values, Index within, double tolerance) {
  if (within > 0) return within;
  return std::count_if(values.begin(), values.end(),
                       [&](double mu) { return std::abs(mu - values[0]) <= tolerance; });
}

// Operators of one family. The last one is kept, because the inner loop of a sweep asks for it again.
class OperatorStore {
 public:
  explicit OperatorStore(InterfaceFamily family) : family_(std::move(family)) {}
  const InterfaceOperator& at(double eta) {
    if (!current_ || current_->eta() != eta) current_ = family_.at(eta);
    return *current_;
  }

 private:
  InterfaceFamily family_;
  std::optional<InterfaceOperator> current_;
};

// Spectra at omega = 1 of one sweep. Neighbours start from each other in blocks of fixed places, so that a
// sweep that starts at any row can start its block again and go on with the same bits.
class Spectra {
 public:
  static constexpr Index block = 8;

  Spectra(InterfaceFamily stage_one, InterfaceFamily stage_two, const SpectralOptions& options)
      : preconditioners_(std::move(stage_two)), systems_(std::move(stage_one)), options_(options) {}

  // `number`: of the pair (epsilon, eta) along the sweep
  const SpectralRadius& at(double epsilon, double eta, Index number) {
    if (number == number_) return current_;
    if (number % block == 0) forget();
    current_ = spectral_radius({preconditioners_.at(eta), systems_.at(epsilon)}, options_, &memory_);
    number_ = number;
    return current_;
  }
  const InterfaceOperator& preconditioner(double eta) { return preconditioners_.at(eta); }

 private:
  void forget() { memory_.forget_ends(); }

  OperatorStore preconditioners_, systems_;
  SpectralOptions options_;
  Continuation memory_;
  SpectralRadius current_;
  Index number_ = -1;
};

void set_exact(SweepResult& result, const SpectralRadius& plain, double tolerance) {
  const bool computed = plain.solver != "none";
  if (!result.point.relaxation) result.point.relaxation = computed ? optimal_relaxation(plain) : 1.0;
  result.radius = relaxed(plain, *result.point.relaxation, tolerance);
  const SpectralRadius& radius = result.radius;
  // With the optimal relaxation both ends are equal and opposite. Rounding must not choose between them.
  const bool low_end = std::abs(radius.eigenvalue_min) > std::abs(radius.eigenvalue_max) * (1 + 1e-9);
  result.dominant = {low_end ? radius.eigenvalue_min : radius.eigenvalue_max, computed ? 0.0 : not_a_number};
}

void set_inexact(SweepResult& result, const Decomposition& stage_one, const InterfaceOperator& preconditioner,
                 const SpectralOptions& options) {
  const SweepPoint& point = result.point;
  const InexactIteration j{TwoStageIteration(stage_one, LinearViscous{point.epsilon}, preconditioner,
                                             Index{*point.gauss_seidel_sweeps}, *point.relaxation)};
  const MapRadius radius = inexact_radius(j, options);
  result.radius.value = radius.value;
  result.radius.unit_multiplicity = radius.unit_multiplicity;
  result.radius.subdominant = radius.subdominant;
  result.radius.solver = radius.solver;
  result.radius.applications = radius.applications;
  result.radius.residual = radius.residual;
  result.radius.converged = radius.converged;
  result.dominant = radius.dominant;
}

// The point with its flexibilities in 1/kg.
SweepPoint at_scale(SweepPoint point, const SweepParameters& parameters, double scale) {
  if (parameters.relative_epsilon) point.epsilon *= scale;
  if (parameters.relative_eta) point.eta *= scale;
  return point;
}

// Columns of certificates and further eigenvalues.
ResultColumns<SpectralRadius> end_columns(const SpectralOptions& options) {
  using Radius = SpectralRadius;
  ResultColumns<Radius> columns;
  if (options.certify)
    columns = {{"certified", "", "inertia counts prove that no eigenvalue lies outside the two intervals",
                &Radius::certified},
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

double flexibility_scale(const Model& model) {
  return model.problem.contacts() == 0 ? 1 : mean_normal_delassus(model.problem);
}

Index point_count(const SweepParameters& parameters) {
  return count(parameters.epsilon) * count(parameters.eta) * count(parameters.relaxation) *
         count(parameters.gauss_seidel_sweeps);
}

SweepPoint sweep_point(const SweepParameters& parameters, Index number) {
  // the digits of `number` in a mixed base, the last list being the lowest digit
  const auto next = [&number](const auto& list) {
    const Index digit = number % count(list);
    number /= count(list);
    return list[at(digit)];
  };
  SweepPoint point;
  point.gauss_seidel_sweeps = next(parameters.gauss_seidel_sweeps);
  point.relaxation = next(parameters.relaxation);
  point.eta = next(parameters.eta);
  point.epsilon = next(parameters.epsilon);
  return point;
}

const ResultColumns<SweepPoint>& point_columns() {
  static const ResultColumns<SweepPoint> columns{
      {"epsilon", "1/kg", "flexibility of the linear law, 0 for the rigid limit", &SweepPoint::epsilon},
      {"eta", "1/kg", "flexibility of the network Stage 2 sees, inf for the generic algorithm",
       &SweepPoint::eta},
      {"relaxation", "1", "omega of F <- F + omega (F' - F)",
       [](const SweepPoint& p) { return p.relaxation.value_or(not_a_number); }},
      {"gauss_seidel_sweeps", "1", "sweeps n_GS of Stage 1, inf where it is exact", [](const SweepPoint& p) {
         return p.gauss_seidel_sweeps ? static_cast<double>(*p.gauss_seidel_sweeps) : infinity;
       }}};
  return columns;
}

Selection select(const Model& model, ContactSet contacts) {
  if (contacts == ContactSet::all) return {contacts, model.parts, model.problem.contacts(), "all"};
  const ContactChoice choice = choose_contacts(model, contacts);
  Selection selection{contacts, restrict_contacts(model.parts, choice.active), 0, choice.rule,
                      choice.certain};
  for (const char flag : choice.active) selection.active_contacts += flag;
  return selection;
}

CaseSummary summary(const Model& model, const Selection& selection) {
  return {model.name,
          model.grains(),
          model.contacts(),
          selection.active_contacts / model.problem.columns_per_contact,
          model.partition.subdomains,
          model.parts.interface_size(),
          selection.contacts,
          selection.rule};
}

const ResultColumns<CaseSummary>& case_columns() {
  static const ResultColumns<CaseSummary> columns{
      {"case", "", "name of the case", &CaseSummary::name},
      {"grains", "1", "grains of the packing", &CaseSummary::grains},
      {"contacts", "1", "contacts of the packing", &CaseSummary::contacts},
      {"active_contacts", "1", "contacts that Stage 1 works with", &CaseSummary::active_contacts},
      {"subdomains", "1", "subdomains of the partition, empty ones included", &CaseSummary::subdomains},
      {"interface_dofs", "1", "interface unknowns n_Gamma", &CaseSummary::interface_size},
      {"contact_set", "", "all (H_E), active or unilateral (G_E) in Stage 1", &CaseSummary::contact_set},
      {"contact_rule", "", "how the contacts of Stage 1 were chosen", &CaseSummary::rule}};
  return columns;
}

const ResultColumns<SweepResult>& place_columns() {
  static const auto columns = joined<SweepResult>(
      {columns_of(&SweepResult::of_case, case_columns()), columns_of(&SweepResult::point, point_columns())});
  return columns;
}

ResultColumns<SweepResult> relative_columns(const SweepParameters& parameters) {
  ResultColumns<SweepResult> columns;
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
      {"spectral_radius", "1", "largest modulus of the eigenvalues of the contraction operator",
       &Radius::value},
      {"eigenvalue_min", "1", "smallest eigenvalue (exact Stage 1 only, else nan)", &Radius::eigenvalue_min},
      {"eigenvalue_max", "1", "largest eigenvalue (exact Stage 1 only, else nan)", &Radius::eigenvalue_max},
      {"unit_multiplicity", "1", "multiplicity of the eigenvalue 1 in the rigid limit",
       &Radius::unit_multiplicity},
      {"subdominant_radius", "1", "largest modulus among the other eigenvalues", &Radius::subdominant}};
  static const ResultColumns<SweepResult> dominant{
      {"dominant_real", "1", "real part of the eigenvalue of largest modulus",
       [](const SweepResult& result) { return result.dominant.real(); }},
      {"dominant_imaginary", "1", "its imaginary part, of a pair the positive one",
       [](const SweepResult& result) { return result.dominant.imag(); }}};
  static const ResultColumns<Radius> certificate{
      {"solver", "", "dense, arpack, shift-invert, or none for an empty interface", &Radius::solver},
      {"applications", "1", "operator applications, 0 where matrices were assembled", &Radius::applications},
      {"residual", "1",
       "an eigenvalue lies within this of each end printed (a plain residual for inexact Stage 1)",
       &Radius::residual},
      {"converged", "1", "the solver converged and the residual is within the tolerance",
       &Radius::converged}};
  return joined<SweepResult>({place_columns(), columns_of(&SweepResult::radius, moduli), dominant,
                              columns_of(&SweepResult::radius, certificate),
                              columns_of(&SweepResult::radius, end_columns(parameters.spectral)),
                              relative_columns(parameters)});
}

Index sweep(const Model& model, const SweepParameters& parameters, const Sink<SweepResult>& sink,
            const Monitor& monitor, Index first) {
  for (const auto& relaxation : parameters.relaxation)
    for (const auto& sweeps : parameters.gauss_seidel_sweeps)
      if (!relaxation && sweeps)
        throw Error(fmt::format(
            "relaxation: expected a number with gauss_seidel_sweeps = {}, met 'optimal', which is "
            "known for an exact Stage 1 only",
            *sweeps));
  const Selection selection = select(model, parameters.contacts);
  const CaseSummary of_case = summary(model, selection);
  const double scale = flexibility_scale(model);
  const SpectralOptions& options = parameters.spectral;
  // With the same contacts P and S are of one family and share what does not depend on the flexibility.
  const InterfaceFamily stage_two(model.parts);
  Spectra spectra(parameters.contacts == ContactSet::all ? stage_two : InterfaceFamily(selection.stage_one),
                  stage_two, options);
  const Index total = point_count(parameters);
  const Index per_pair = count(parameters.relaxation) * count(parameters.gauss_seidel_sweeps);
  const Index replayed = Spectra::block * per_pair;
  const bool warm =
      choose_solver(model.parts.interface_size(), false, options).solver != SpectralSolver::dense;
  Index failed = 0;
  for (Index number = warm ? first - first % replayed : first; number < total; ++number) {
    const SweepPoint asked = sweep_point(parameters, number);
    SweepResult result{of_case, at_scale(asked, parameters, scale), {}, {}, asked, scale};
    const auto& [epsilon, eta, relaxation, sweeps] = result.point;
    if (number < first && sweeps) continue;
    if (sweeps)
      set_inexact(result, selection.stage_one, spectra.preconditioner(eta), options);
    else
      set_exact(result, spectra.at(epsilon, eta, number / per_pair), options.tolerance);
    if (number < first) {  // only to warm up the block that the first row belongs to
      if (!report(monitor, first, total)) return failed;
      continue;
    }
    result.radius.converged &= selection.certain;  // a radius of uncertain contacts proves nothing
    failed += !result.radius.converged;
    sink(result);
    if (!report(monitor, number + 1, total)) return failed;
  }
  return failed;
}

KnownCells known_of_point(const StudyTable& table, Index number) {
  const SweepPoint point = sweep_point(table.sweep, number);
  KnownCells cells;
  for (const auto& [heading, value] : point_columns()) {
    const bool relative = (heading.name == "epsilon" && table.sweep.relative_epsilon) ||
                          (heading.name == "eta" && table.sweep.relative_eta);
    if (point.relaxation || heading.name != "relaxation")  // the optimal one is known with the spectrum
      cells.emplace_back(heading.name + (relative ? "_relative" : ""), value(point));
  }
  return cells;
}

constinit const Observable observables::spectral_radius{
    .name = "spectral_radius",
    .summary = "spectral radius of the contraction operator at every point of a sweep",
    .keys = {"epsilon", "eta", "relaxation", "gauss_seidel_sweeps", "contacts", "solver", "certify"},
    .columns = [](const StudyTable& table) { return headings(sweep_columns(table.sweep)); },
    .run =
        [](const ObservedCase& work) {
          const SweepParameters& parameters = work.table.sweep;
          return sweep(build(work.one), parameters, as_rows(sweep_columns(parameters), work.sink),
                       work.monitor, work.first);
        },
    .rows = [](const StudyTable& table) { return point_count(table.sweep); },
    .known = known_of_point};

}  // namespace nscdd
