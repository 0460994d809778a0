// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/pencil.hpp"
#include "study/moving/moving_tables.hpp"
#include "two_stage/cut_contacts.hpp"

namespace nscdd {
namespace {

constexpr Index most_eigenvalues = 2500;
constexpr Index most_iterations = 3000;
constexpr double frozen_proximal = 1e-5;   // alpha / W_nn of the linear systems compared, the first of Newton's steps
constexpr double frozen_tolerance = 1e-8;  // relative jumps after the iterations compared

// One linear system of the two-stage Newton method with one network in Stage 2.
struct FrozenInterface {
  Index iterations = 0;             // of the Krylov method
  double predicted = not_a_number;  // the same from the eigenvalues of P^-1 S; NaN above 2 500 unknowns
  // Of Richardson's iteration F <- F + P^-1 (g - S F), from the radius rho of I - P^-1 S; infinite for rho >= 1.
  double richardson = not_a_number;
};

// A step by the two-stage Newton method, and the linear system at its end with each network in Stage 2.
struct InterfaceIterations {
  StepReport report;
  Index subdomains = 0;
  Index stick = 0, slide = 0;  // contacts at the end
  // Preconditioners at these statuses: X, X_eta of all and of active contacts, then, of the active contacts with the
  // stiffness of the system, lumped and Dirichlet (multiplicity), Dirichlet (deluxe), the same with GenEO.
  FrozenInterface none, all, active, lumped, dirichlet, deluxe, geneo;
  Index undivided_factorisations = 0;  // of the same step on one subdomain
  // The same step by other methods, with the limit solver.maximum_iterations; of ADMM in hundreds.
  struct Rival {
    Index iterations = 0;
    bool converged = false;
  };
  Rival generic, enriched;  // Algorithm 1 with its defaults, to zeta <= 1e-4
  Rival admm;               // two-stage ADMM to the tolerance of the case, with an interface solve per iteration

  bool known() const { return report.status == SolverStatus::converged; }
  double iterations_per_system() const {
    const auto systems = static_cast<double>(report.interface_systems);
    return systems == 0 ? 0 : static_cast<double>(report.interface_iterations) / systems;  // 0 if sweeps sufficed
  }
};

// A linear system of Newton's method at the end of a step: its relations and its right-hand side.
template <int D>
struct FrozenSystem {
  std::vector<ContactRelation<D>> relations;
  Vector right;
};

template <int D>
FrozenSystem<D> frozen_system(const GranularStep<D>& step) {
  const double alpha = frozen_proximal * step.problem.scale;
  FrozenSystem<D> system{{}, Vector(D * count(step.contacts))};
  // A law that pulls is Coulomb's for r + pull: the pulls act on the free velocities.
  std::vector<GrainVelocity<D>> free = step.problem.free;
  for (const GrainContact<D>& contact : step.contacts) apply_impulse(contact, LocalVector<D>{-contact.pull, {}}, free);
  for (Index c = 0; c < count(step.contacts); ++c) {
    const GrainContact<D>& contact = step.contacts[at(c)];
    const double rho = 1 / (1 / inverse_normal_delassus(contact) + alpha);
    const LocalVector<D> now = relative_velocity(contact, step.velocities) + contact.bias;
    const LocalVector<D> impulse = contact.impulse + LocalVector<D>{contact.pull, {}};
    const FrozenContact<D> frozen = frozen_contact(impulse - rho * now, contact.friction);
    const ContactRelation<D> relation = ContactRelation<D>::of(frozen, alpha, rho);
    const LocalVector<D> u = relative_velocity(contact, free) + contact.bias;
    set_component(system.right, c, alpha * impulse - u);
    system.right.template segment<D>(D * c) = relation.q * system.right.template segment<D>(D * c);
    system.relations.push_back(relation);
  }
  return system;
}

template <int D>
FrozenInterface frozen_interface(const Decomposition& parts, const FrozenSystem<D>& system, CutOptions options) {
  options.tolerance = frozen_tolerance;
  options.maximum_iterations = most_iterations;
  options.inertia = multifrontal();
  CutContacts<D> cut(parts, options);
  FrozenInterface result;
  if (parts.interface_size() == 0 || !cut.factorise(system.relations)) return result;
  cut.solve(system.right);
  result.iterations = cut.work().iterations;
  if (parts.interface_size() > most_eigenvalues) return result;
  Matrix map = cut.dense();
  for (Index k = 0; k < map.cols(); ++k) map.col(k) = cut.precondition(map.col(k));
  const Eigen::VectorXcd eigenvalues = general_eigen(std::move(map), Eigenvectors::not_wanted).values;
  if (eigenvalues.size() == 0) return result;
  result.predicted = static_cast<double>(predicted_iterations(eigenvalues, {frozen_tolerance, most_iterations}));
  const double radius = (1.0 - eigenvalues.array()).abs().maxCoeff();
  result.richardson = radius < 1 ? std::ceil(std::log(frozen_tolerance) / std::log(radius)) : infinity;
  return result;
}

template <int D>
InterfaceIterations by_newton(const Simulation& simulation) {
  const double flexibility = simulation.dynamics.solver.interface_flexibility;
  const GranularStep<D> step = solve_step<D>(simulation);
  InterfaceIterations result;
  result.report = step.report;
  result.subdomains = step.partition.subdomains;

  for (const GrainContact<D>& contact : step.contacts) {
    const ContactStatus status = status_of(step.problem.law, contact);
    result.stick += status == ContactStatus::stick;
    result.slide += status != ContactStatus::stick && status != ContactStatus::open;
  }
  const Decomposition parts =
      decompose(reference_problem(step.problem, simulation.system.bodies()), partition_of_columns(step.partition, D));
  const FrozenSystem<D> system = frozen_system(step);
  const auto with = [&](const CutOptions& options) { return frozen_interface(parts, system, options); };
  using enum InterfacePreconditioner;
  result.none = with({.preconditioner = inertia});
  result.all = with({.preconditioner = network, .flexibility = flexibility});
  result.active = with({.preconditioner = active, .flexibility = flexibility});
  result.lumped = with({.preconditioner = lumped, .scaling = Scaling::multiplicity});
  result.dirichlet = with({.preconditioner = dirichlet, .scaling = Scaling::multiplicity});
  result.deluxe = with({.preconditioner = dirichlet, .scaling = Scaling::deluxe});
  result.geneo = with({.preconditioner = dirichlet, .scaling = Scaling::deluxe, .coarse_space = CoarseSpace::geneo});
  return result;
}

InterfaceIterations::Rival by_algorithm_1(Simulation simulation, StepAlgorithm algorithm) {
  const Index most = simulation.dynamics.solver.maximum_iterations;
  simulation.dynamics.solver = {.algorithm = algorithm,
                                .maximum_iterations = most,
                                .criterion = Criterion::zeta,
                                .tolerance = 1e-4,
                                .warm_start = false,
                                .eta = {}};
  const StepReport report = solved_report(simulation);
  return {report.last.iteration, report.status == SolverStatus::converged};
}

InterfaceIterations::Rival by_admm(Simulation simulation) {
  StepSolver& solver = simulation.dynamics.solver;
  solver.algorithm = StepAlgorithm::two_stage_admm;
  solver.maximum_iterations = std::max<Index>(solver.maximum_iterations / 100, 1);  // each of 100 ADMM iterations
  const StepReport report = solved_report(simulation);
  return {report.last.sweeps, report.status == SolverStatus::converged};
}

// Compares solvers on the next step of a simulation with the solver two_stage_newton.
InterfaceIterations interface_iterations(const Simulation& simulation) {
  InterfaceIterations result =
      in_dimension(simulation.system, [&](auto dimension) { return by_newton<dimension()>(simulation); });
  Simulation undivided = simulation;
  undivided.partitioner = GridPartitioner{.grid = {1, 1}};
  undivided.state.decomposed_at = -1;
  result.undivided_factorisations = solved_report(undivided).factorisations;
  result.generic = by_algorithm_1(simulation, StepAlgorithm::generic);
  result.enriched = by_algorithm_1(simulation, StepAlgorithm::enriched);
  result.admm = by_admm(simulation);
  return result;
}

ResultColumns<FrozenInterface> frozen_columns(const std::string& network, const std::string& words) {
  return {{"iterations_" + network, "1", "Krylov iterations of the last system with " + words + " in Stage 2",
           &FrozenInterface::iterations},
          {"predicted_" + network, "1", "the same from the spectrum of P^-1 S; nan above 2 500 unknowns",
           &FrozenInterface::predicted},
          {"richardson_" + network, "1", "Richardson iterations instead, from the spectral radius of I - P^-1 S",
           &FrozenInterface::richardson}};
}

ResultColumns<InterfaceIterations::Rival> rival_columns(const std::string& name, const std::string& words) {
  using Rival = InterfaceIterations::Rival;
  return {{name + "_iterations", "1", "of " + words, &Rival::iterations},
          {name + "_converged", "", "whether it converged within maximum_iterations", &Rival::converged}};
}

ResultColumns<InterfaceIterations> cut_columns() {
  using Found = InterfaceIterations;
  return joined<Found>(
      {{{"subdomains", "1", "number of subdomains", &Found::subdomains},
        {"stick", "1", "contacts that stick at the end", &Found::stick},
        {"slide", "1", "contacts that slide at the end", &Found::slide},
        {"natural_map", "1", "|natural map| / max(|r|, |r^1|) at the end",
         [](const Found& f) { return f.report.residual.relative_natural_map(); }},
        {"outer_steps", "1", "matrices factorised in the step", [](const Found& f) { return f.report.factorisations; }},
        {"outer_steps_undivided", "1", "the same on one subdomain", &Found::undivided_factorisations},
        {"systems", "1", "systems solved at the interface, two for each linear system",
         [](const Found& f) { return f.report.interface_systems; }},
        {"iterations_per_system", "1", "iterations at the interface, mean over these systems",
         &Found::iterations_per_system}},
       columns_of(&Found::none, frozen_columns("none", "no contacts")),
       columns_of(&Found::all, frozen_columns("all", "all contacts")),
       columns_of(&Found::active, frozen_columns("active", "the active contacts")),
       columns_of(&Found::lumped, frozen_columns("lumped", "the lumped preconditioner")),
       columns_of(&Found::dirichlet, frozen_columns("dirichlet", "the Dirichlet preconditioner")),
       columns_of(&Found::deluxe, frozen_columns("deluxe", "the same with deluxe weights")),
       columns_of(&Found::geneo, frozen_columns("geneo", "that and a coarse space of GenEO")),
       columns_of(&Found::generic, rival_columns("generic", "the generic Algorithm 1, to zeta 1e-4")),
       columns_of(&Found::enriched, rival_columns("enriched", "the enriched one with eta = 30 W")),
       columns_of(&Found::admm, rival_columns("admm", "two-stage ADMM, to the tolerance")),
       {{"converged", "", "whether the step did", &Found::known}}});
}

}  // namespace

constinit const Observable observables::interface_iterations = examined_steps<cut_columns, nscdd::interface_iterations>(
    {.name = "interface_iterations",
     .summary =
         "outer steps and iterations at the interface of a step by the two-stage Newton method, with those predicted",
     .check = [](const CaseSpec& spec) {
       if (const StepSolver& solver = spec.dynamics->solver; solver.algorithm != StepAlgorithm::two_stage_newton)
         throw Error("solver.algorithm", fmt::format("expected {}, met {}", to_string(StepAlgorithm::two_stage_newton),
                                                     to_string(solver.algorithm)));
     }});

}  // namespace nscdd
