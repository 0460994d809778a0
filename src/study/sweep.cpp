// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/inexact_stage_one.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/study/sweep.hpp>

#include <fmt/format.h>

#include <cmath>

namespace nscdd {
namespace {

void append(Row& row, std::initializer_list<Cell> cells) {
  row.insert(row.end(), cells.begin(), cells.end());
}

std::int64_t integer(Index value) { return static_cast<std::int64_t>(value); }

double optimal_relaxation(const SpectralRadius& plain) {
  // omega = 2 / (lambda_min + lambda_max) over the eigenvalues lambda = 1 - mu outside the kernel
  return 2.0 / (2.0 - plain.subdominant_min - plain.subdominant_max);
}

// Eigenvalues in the certified interval, or else those found that agree with the first within the tolerance.
Index multiplicity(const std::vector<double>& values, Index within, double tolerance) {
  if (within > 0) return within;
  return std::count_if(values.begin(), values.end(),
                       [&](double mu) { return std::abs(mu - values[0]) <= tolerance; });
}

// Operators of one family; the last one made is kept, which serves the inner loop of a sweep.
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

// Cells of `end_columns`.
Row end_cells(const SpectralRadius& radius, const SpectralOptions& options) {
  Row row;
  if (options.certify)
    append(row, {radius.certified, radius.interval_min[0], radius.interval_min[1], radius.interval_max[0],
                 radius.interval_max[1]});
  if (options.certify || options.eigenvalues > 1)
    append(row, {integer(multiplicity(radius.low, radius.within_min, options.tolerance)),
                 integer(multiplicity(radius.high, radius.within_max, options.tolerance))});
  if (options.eigenvalues > 1)
    for (const auto& values : {radius.low, radius.high})
      for (Index k = 0; k < options.eigenvalues; ++k)
        row.emplace_back(k < count(values) ? values[at(k)] : not_a_number);
  return row;
}

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

Row exact_cells(const SpectralRadius& plain, const std::optional<double>& relaxation,
                const SpectralOptions& options) {
  const bool computed = plain.solver != "none";
  const double omega = relaxation.value_or(computed ? optimal_relaxation(plain) : 1.0);
  const SpectralRadius radius = relaxed(plain, omega, options.tolerance);
  // Where the ends are equal and opposite (optimal relaxation) rounding must not choose between them.
  const bool low_end = std::abs(radius.eigenvalue_min) > std::abs(radius.eigenvalue_max) * (1 + 1e-9);
  const double dominant = low_end ? radius.eigenvalue_min : radius.eigenvalue_max;
  Row row;
  append(row, {omega, infinity, radius.value, radius.eigenvalue_min, radius.eigenvalue_max,
               integer(radius.unit_multiplicity), radius.subdominant, dominant, computed ? 0.0 : not_a_number,
               std::string(radius.solver), integer(radius.applications), radius.residual, radius.converged});
  for (const Cell& cell : end_cells(radius, options)) row.push_back(cell);
  return row;
}

Row inexact_cells(const Decomposition& stage_one, const InterfaceOperator& preconditioner, double epsilon,
                  long sweeps, double relaxation, const SpectralOptions& options) {
  const InexactIteration j{
      TwoStageIteration(stage_one, LinearViscous{epsilon}, preconditioner, Index{sweeps}, relaxation)};
  const InexactRadius radius = inexact_radius(j, options);
  Row row;
  append(row, {relaxation, static_cast<double>(sweeps), radius.value, not_a_number, not_a_number,
               integer(radius.unit_multiplicity), radius.subdominant, radius.dominant.real(),
               radius.dominant.imag(), std::string(radius.solver), integer(radius.applications),
               radius.residual, radius.converged});
  SpectralRadius unknown;
  unknown.solver = "none";
  for (const Cell& cell : end_cells(unknown, options)) row.push_back(cell);
  return row;
}

}  // namespace

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

Selection select(const Model& model, ContactSet contacts) {
  if (contacts == ContactSet::all) return {model.parts, model.problem.contacts(), "all"};
  const ContactChoice choice = choose_contacts(model, contacts);
  Selection selection{restrict_contacts(model.parts, choice.active), 0, choice.rule, choice.certain};
  for (const char flag : choice.active) selection.active_contacts += flag;
  return selection;
}

std::vector<Column> case_columns() {
  return {{"case", "", "name of the case"},
          {"grains", "1", "grains of the packing"},
          {"contacts", "1", "contacts of the packing"},
          {"active_contacts", "1", "contacts that Stage 1 works with"},
          {"subdomains", "1", "subdomains of the partition, empty ones included"},
          {"interface_dofs", "1", "interface unknowns n_Gamma"},
          {"contact_set", "", "all (H_E), active or unilateral (G_E) in Stage 1"},
          {"contact_rule", "", "how the contacts of Stage 1 were chosen"}};
}

Row case_cells(const Model& model, const Selection& selection, ContactSet contacts) {
  Row row;
  append(row, {model.name, integer(model.grains()), integer(model.contacts()),
               integer(selection.active_contacts / model.problem.columns_per_contact),
               integer(model.partition.subdomains), integer(model.parts.interface_size()),
               std::string(to_string(contacts)), selection.rule});
  return row;
}

std::vector<Column> point_columns() {
  std::vector<Column> columns = case_columns();
  const std::vector<Column> more{
      {"epsilon", "1/kg", "flexibility of the linear law, 0 for the rigid limit"},
      {"eta", "1/kg", "flexibility of the network Stage 2 sees, inf for the generic algorithm"},
      {"relaxation", "1", "omega of F <- F + omega (F' - F)"},
      {"gauss_seidel_sweeps", "1", "sweeps n_GS of Stage 1, inf where it is exact"}};
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

std::vector<Column> end_columns(const SpectralOptions& options) {
  std::vector<Column> columns;
  if (options.certify)
    columns = {
        {"certified", "", "inertia counts prove that no eigenvalue lies outside the two intervals"},
        {"low_from", "1", "interval that holds the low end of the spectrum (unit eigenvalues apart)"},
        {"low_to", "1", "its upper bound"},
        {"high_from", "1", "interval that holds the high end of the spectrum (unit eigenvalues apart)"},
        {"high_to", "1", "its upper bound"}};
  if (options.certify || options.eigenvalues > 1) {
    columns.push_back(
        {"low_multiplicity", "1", "eigenvalues within the interval (else: found) at the low end"});
    columns.push_back(
        {"high_multiplicity", "1", "eigenvalues within the interval (else: found) at the high end"});
  }
  if (options.eigenvalues > 1)
    for (const std::string end : {"low", "high"})
      for (Index k = 1; k <= options.eigenvalues; ++k)
        columns.push_back({fmt::format("eigenvalue_{}_{}", end, k), "1",
                           fmt::format("number {} from the {} end, unit eigenvalues apart", k, end)});
  return columns;
}

std::vector<Column> sweep_columns(const SpectralOptions& options) {
  std::vector<Column> columns = point_columns();
  const std::vector<Column> more{
      {"spectral_radius", "1", "largest modulus of the eigenvalues of the contraction operator"},
      {"eigenvalue_min", "1", "smallest eigenvalue (exact Stage 1 only, else nan)"},
      {"eigenvalue_max", "1", "largest eigenvalue (exact Stage 1 only, else nan)"},
      {"unit_multiplicity", "1", "multiplicity of the eigenvalue 1 in the rigid limit"},
      {"subdominant_radius", "1", "largest modulus among the other eigenvalues"},
      {"dominant_real", "1", "real part of the eigenvalue of largest modulus"},
      {"dominant_imaginary", "1", "its imaginary part, of a pair the positive one"},
      {"solver", "", "dense, arpack, shift-invert, or none for an empty interface"},
      {"applications", "1", "operator applications, 0 where matrices were assembled"},
      {"residual", "1",
       "an eigenvalue lies within this of each end printed (a plain residual for inexact Stage 1)"},
      {"converged", "1", "the solver converged and the residual is within the tolerance"}};
  columns.insert(columns.end(), more.begin(), more.end());
  const std::vector<Column> ends = end_columns(options);
  columns.insert(columns.end(), ends.begin(), ends.end());
  return columns;
}

Index sweep(const Model& model, const SweepParameters& parameters, const RowSink& sink,
            const Monitor& monitor, Index first) {
  for (const auto& relaxation : parameters.relaxation)
    for (const auto& sweeps : parameters.gauss_seidel_sweeps)
      if (!relaxation && sweeps)
        throw Error(fmt::format(
            "relaxation: expected a number with gauss_seidel_sweeps = {}, met 'optimal', which is "
            "known for an exact Stage 1 only",
            *sweeps));
  const Selection selection = select(model, parameters.contacts);
  const Row head = case_cells(model, selection, parameters.contacts);
  const SpectralOptions& options = parameters.spectral;
  // One family where the contacts are the same: P and S then share what does not depend on them.
  const InterfaceFamily stage_two(model.parts);
  Spectra spectra(parameters.contacts == ContactSet::all ? stage_two : InterfaceFamily(selection.stage_one),
                  stage_two, options);
  const Index total = point_count(parameters);
  const Index per_pair = count(parameters.relaxation) * count(parameters.gauss_seidel_sweeps);
  const Index replayed = Spectra::block * per_pair;
  const bool warm =
      options.solver == SpectralSolver::shift_invert || options.solver == SpectralSolver::arpack ||
      (options.solver == SpectralSolver::automatic && model.parts.interface_size() > options.dense_limit);
  Index failed = 0;
  const std::size_t converged_column = sweep_columns().size() - 1;
  for (Index number = warm ? first - first % replayed : first; number < total; ++number) {
    const auto [epsilon, eta, relaxation, sweeps] = sweep_point(parameters, number);
    if (number < first && sweeps) continue;
    Row row = head;
    append(row, {epsilon, eta});
    const Row cells = sweeps ? inexact_cells(selection.stage_one, spectra.preconditioner(eta), epsilon,
                                             *sweeps, *relaxation, options)
                             : exact_cells(spectra.at(epsilon, eta, number / per_pair), relaxation, options);
    if (number < first) {  // the block that the first row belongs to
      if (!report(monitor, first, total)) return failed;
      continue;
    }
    row.insert(row.end(), cells.begin(), cells.end());
    if (!selection.certain) row[converged_column] = false;  // the radius of an uncertain set of contacts
    if (!std::get<bool>(row[converged_column])) ++failed;
    sink(row);
    if (!report(monitor, number + 1, total)) return failed;
  }
  return failed;
}

}  // namespace nscdd
