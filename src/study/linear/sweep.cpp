// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/range_projector.hpp"
#include "linalg/sparse_entries.hpp"
#include "mechanics/active_set.hpp"
#include "mechanics/contact_blocks.hpp"
#include "mechanics/contact_law.hpp"
#include "spectra/spectrum_memory.hpp"
#include "study/linear/sweep_points.hpp"
#include "two_stage/two_stage.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/study/sweep.hpp>

namespace nscdd {
namespace {

// Operators of one family, the last one kept for the inner loop of a sweep.
struct OperatorStore {
  InterfaceFamily family;
  std::optional<InterfaceOperator> last = {};

  const InterfaceOperator& at(double eta) {
    if (!last || last->flexibility() != eta) last = family.at(eta);
    return *last;
  }
};

// Spectra at omega = 1 of one sweep. Neighbours start from each other in fixed blocks, so that a sweep from any row
// repeats the beginning of its block and goes on with the same bits. The blocks are short, because a resumed sweep
// computes up to a block again; a single block would save at most 10 % of the time, which goes into factorisations.
class Spectra {
 public:
  static constexpr Index block = 8;

  Spectra(InterfaceFamily stage_one, InterfaceFamily stage_two, const SweepParameters& parameters)
      : preconditioners_{std::move(stage_two)},
        systems_{std::move(stage_one)},
        options_(parameters.spectral),
        scheme_(parameters.scheme) {}

  // `number`: of the pair (epsilon, eta) in the sweep
  const SpectralRadius& at(double epsilon, double eta, Index number) {
    if (number == number_) return current_;
    if (number % block == 0) memory_.forget_ends();
    current_ = spectral_radius({preconditioners_.at(eta), systems_.at(epsilon), 1, scheme_}, options_, &memory_);
    number_ = number;
    return current_;
  }
  const InterfaceOperator& preconditioner(double eta) { return preconditioners_.at(eta); }

 private:
  OperatorStore preconditioners_, systems_;
  SpectralOptions options_;
  DecompositionScheme scheme_;
  SpectrumMemory memory_;
  SpectralRadius current_;
  Index number_ = -1;
};

void set_inexact(SweepResult& result, const Decomposition& stage_one, const InterfaceOperator& preconditioner,
                 const SweepParameters& parameters) {
  const SweepPoint& point = result.point;
  const TwoStageIteration iteration(stage_one, LinearViscous{point.epsilon}, preconditioner, point.gauss_seidel_sweeps,
                                    *point.relaxation, parameters.scheme);
  const MapRadius radius = inexact_radius(iteration, parameters.spectral);
  result.radius = radius;
  result.dominant = radius.dominant;
}

// Whether the columns of H of all closed contacts are independent. Impulses are then unique. They may also be unique if
// every self-stress needs an idle contact, which is not checked.
bool unique_impulses(const ReferenceProblem& problem, const std::vector<UnilateralStatus>& status) {
  std::vector<Index> closed;
  std::vector<char> touched(at(problem.grains()), 0);
  for (Index c = 0; c < problem.contacts(); ++c) {
    if (status[at(c)] == UnilateralStatus::open) continue;
    for (const Index grain : grains_of_contact(problem, c)) touched[at(grain)] = 1;
    closed.push_back(c);
  }
  if (closed.empty()) return true;
  // More columns than motions other than translations cannot be independent, which spares large packings a
  // factorisation. (Rotations are no rigid motions of a periodic cell.)
  const Index grains = std::count(touched.begin(), touched.end(), 1);
  if (count(closed) > problem.dofs_per_grain * grains - problem.dimension) return false;
  return sparse_rank(selected_columns(problem.h, closed)).value == count(closed);
}

template <int D>
ContactChoice frozen_contacts(const GlobalFrictionProblem& global, const std::string& name) {
  const LocalFrictionProblem problem = reduce(global, name);
  const FrictionSolverOptions how;
  const FrictionSolution solution = solve_friction(problem, how);
  const double least = how.tolerance * (problem.size() > 0 ? solution.impulses.cwiseAbs().maxCoeff() : 0);
  ContactChoice choice{.active = std::vector<char>(at(problem.size()), 0),
                       .impulses = solution.impulses,
                       .rule = "sticking and sliding in the solution with friction",
                       .solution = "frozen",
                       .certain = solution.status == FrictionStatus::converged};
  for (Index c = 0; c < problem.contacts(); ++c) {
    const double rho = 1 / problem.w.coeff(D * c, D * c);
    const LocalVector<D> moved = component<D>(solution.impulses, c) - rho * component<D>(solution.state.velocities, c);
    const ContactStatus status = moved.n <= least ? ContactStatus::open : contact_status(moved, problem.friction[c]);
    const Index columns = status == ContactStatus::open ? 0 : status == ContactStatus::stick ? D : 1;
    std::fill_n(choice.active.begin() + D * c, columns, char{1});
  }
  return choice;
}

}  // namespace

void set_exact(SweepResult& result, const SpectralRadius& plain, double tolerance) {
  const bool computed = plain.solver != "none";
  // The optimal relaxation is 2 / (lambda_min + lambda_max) over the eigenvalues lambda = 1 - mu outside the kernel.
  if (!result.point.relaxation)
    result.point.relaxation = computed && std::isfinite(plain.subdominant_min)
                                  ? 2.0 / (2.0 - plain.subdominant_min - plain.subdominant_max)
                                  : 1.0;
  result.radius = relaxed(plain, *result.point.relaxation, tolerance);
  const SpectralRadius& radius = result.radius;
  // With the optimal relaxation both ends are equal and opposite: rounding must not choose.
  const bool low_end = std::abs(radius.eigenvalue_min) > std::abs(radius.eigenvalue_max) * (1 + 1e-9);
  result.dominant = {low_end ? radius.eigenvalue_min : radius.eigenvalue_max, computed ? 0.0 : not_a_number};
}

void withdraw_if_uncertain(SpectralRadius& radius, const Selection& selection) {
  if (selection.certain) return;
  radius.converged = false;
  radius.failure = uncertain_choice;
}

SweepPoint at_scale(SweepPoint point, const SweepParameters& parameters, double scale) {
  if (parameters.relative_epsilon) point.epsilon *= scale;
  if (parameters.relative_eta) point.eta *= scale;
  return point;
}

double flexibility_scale(const Model& model) { return model.flexibility; }

std::vector<std::string> remarks_on(const Model& model, const SweepParameters& sweep) {
  if (!sweep.schwarz()) return {};
  const Interface& glued = model.parts.interface;
  Index q = 1;
  glued.for_glued_grains([&](Index grain, Index, Index) { q = std::max(q, glued.multiplicity(grain)); });
  if (q < 2) return {};
  const bool rigid = std::ranges::find(sweep.epsilon, 0.0) != sweep.epsilon.end();
  std::vector<std::string> remarks;
  for (const std::optional<double>& relaxation : sweep.relaxation)
    if (const double product = relaxation.value_or(0) * static_cast<double>(q); product > 2 || (product == 2 && rigid))
      remarks.push_back(
          fmt::format("{}: up to {} subdomains share a body, and schwarz may not converge with a relaxation of {:.3g} "
                      "or more, met {}",
                      model.name, q, 2 / static_cast<double>(q), *relaxation));
  return remarks;
}

Model built_for(const SweepParameters& sweep, const Case& one) {
  Model model = build(one);
  if (one.remark) std::ranges::for_each(remarks_on(model, sweep), one.remark);
  return model;
}

Index point_count(const SweepParameters& parameters) {
  return count(parameters.epsilon) * count(parameters.eta) * count(parameters.relaxation) *
         count(parameters.gauss_seidel_sweeps);
}

SweepPoint sweep_point(const SweepParameters& parameters, Index number) {
  // the digits of `number` in a mixed base, the last list the lowest
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

void check_sweep(const SweepParameters& parameters, std::string_view dashes) {
  require_solver_of(parameters.scheme, parameters.spectral, dashes);
  for (const double eta : parameters.eta)
    if (parameters.schwarz() && eta != infinity)
      fail("{0}eta: expected none with {0}scheme schwarz, which has no Stage 2, met {1}", dashes, eta);
  const std::string_view key = dashes.empty() ? "gauss_seidel_sweeps" : "--gauss-seidel-sweeps";
  const SpectralOptions& spectral = parameters.spectral;
  for (const auto& sweeps : parameters.gauss_seidel_sweeps) {
    if (!sweeps) continue;
    if (spectral.certify || spectral.eigenvalues > 1)
      fail("{0}: expected inf with {1}certify or {1}eigenvalues (an inexact Stage 1 has no symmetric pencil), met {2}",
           key, dashes, *sweeps);
    if (std::ranges::any_of(parameters.relaxation, [](const auto& relaxation) { return !relaxation; }))
      fail("{}relaxation: expected a number with {} = {}, met 'optimal', which is known for an exact Stage 1 only",
           dashes, key, *sweeps);
  }
}

ContactChoice choose_contacts(const Model& model, ContactSet contacts) {
  const ReferenceProblem& problem = model.problem;
  if (contacts == ContactSet::all)
    return {.active = std::vector<char>(at(problem.contacts()), 1), .impulses = {}, .rule = "all", .solution = "none"};
  if (contacts == ContactSet::frozen) {
    if (!model.friction) fail("{}: expected a contact problem with --contacts frozen, met a packing", model.name);
    return model.problem.dimension == 2 ? frozen_contacts<2>(*model.friction, model.name)
                                        : frozen_contacts<3>(*model.friction, model.name);
  }
  if (problem.columns_per_contact > 1)
    fail(
        "{}: expected --contacts all or frozen for a problem with friction, met {}: its rule is that of frictionless "
        "contacts",
        model.name, to_string(contacts));
  if (contacts == ContactSet::active) {
    const RigidImpulses rigid = rigid_impulses(problem);
    return {.active = active_contacts(problem, rigid),
            .impulses = rigid.impulses,
            .rule = rigid.unique ? "compressive (unique)" : "compressive (least norm)",
            .solution = rigid.unique ? "unique" : "least_norm",
            .certain = rigid.residual <= 1e-8};
  }
  require_arriving_velocity(problem);
  const UnilateralImpulses solved = unilateral_impulses(problem);
  const bool unique = unique_impulses(problem, solved.status);
  std::vector<char> carrying;
  for (const UnilateralStatus status : solved.status) carrying.push_back(status == UnilateralStatus::carrying);
  return {.active = carrying,
          .impulses = solved.impulses,
          .rule = unique ? "complementarity (unique)" : "complementarity (maximal)",
          .solution = unique ? "unilateral_unique" : "unilateral_maximal",
          .idle = solved.count(UnilateralStatus::idle),
          .certain = solved.converged};
}

Selection select(const Model& model, ContactSet contacts) {
  return select(model, contacts, choose_contacts(model, contacts));
}

Selection select(const Model& model, ContactSet contacts, const ContactChoice& choice) {
  Index active_contacts = 0;  // by their normals
  for (Index c = 0; c < count(choice.active); c += model.problem.columns_per_contact)
    active_contacts += choice.active[at(c)] != 0;
  const CaseSummary of_case{.name = model.name,
                            .grains = model.grains(),
                            .contacts = model.contacts(),
                            .active_contacts = active_contacts,
                            .subdomains = model.partition.subdomains,
                            .interface_size = model.parts.interface_size(),
                            .contact_set = contacts,
                            .rule = choice.rule};
  if (contacts == ContactSet::all) return {of_case, {}, choice.certain};
  return {of_case, restrict_contacts(model.parts, choice.active), choice.certain};
}

Index sweep(const Model& model, const SweepParameters& parameters, const Sink<SweepResult>& sink,
            const Monitor& monitor, Index first) {
  check_sweep(parameters);
  return sweep(model, select(model, parameters.contacts), parameters, sink, monitor, first);
}

Index sweep(const Model& model, const Selection& selection, const SweepParameters& parameters,
            const Sink<SweepResult>& sink, const Monitor& monitor, Index first) {
  const double scale = flexibility_scale(model);
  const SpectralOptions& options = parameters.spectral;
  // With the same contacts P and S are of one family, which shares data.
  const std::optional<Decomposition> whole =
      parameters.schwarz() ? std::optional(whole_masses(selection.stage_one(model))) : std::nullopt;
  const Decomposition& stage_one = whole ? *whole : selection.stage_one(model);
  const InterfaceFamily stage_two(whole ? *whole : model.parts);
  Spectra spectra(selection.restricted && !whole ? InterfaceFamily(stage_one) : stage_two, stage_two, parameters);
  const Index total = point_count(parameters);
  const Index per_pair = count(parameters.relaxation) * count(parameters.gauss_seidel_sweeps);
  const Index replayed = Spectra::block * per_pair;
  const bool warm = choose_solver(stage_one.interface_size(), options).solver != SpectralSolver::dense;
  Index failed = 0;
  for (Index number = warm ? first - first % replayed : first; number < total; ++number) {
    const SweepPoint asked = sweep_point(parameters, number);
    SweepResult result{selection.of_case, at_scale(asked, parameters, scale), {}, {}, asked, scale};
    const auto& [epsilon, eta, relaxation, sweeps] = result.point;
    if (number < first && sweeps) continue;
    if (sweeps)
      set_inexact(result, stage_one, spectra.preconditioner(eta), parameters);
    else
      set_exact(result, spectra.at(epsilon, eta, number / per_pair), options.tolerance);
    if (number < first) {  // warms up the block of the first row
      if (!report(monitor, first, total)) return failed;
      continue;
    }
    withdraw_if_uncertain(result.radius, selection);
    failed += !result.radius.converged;
    sink(result);
    if (!report(monitor, number + 1, total)) return failed;
  }
  return failed;
}

}  // namespace nscdd
