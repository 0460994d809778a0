// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/contact_solver_step.hpp"

#include "contact_solvers/contact_turns.hpp"
#include "contact_solvers/stored_contacts.hpp"
#include "simulation/step_decomposition.hpp"

namespace nscdd {
namespace {

// The impulses r + pull, which obey Coulomb's law.
template <int D>
Vector shifted_impulses(const StepProblem<D>& problem) {
  Vector r(D * count(problem.contacts));
  for (Index c = 0; c < count(problem.contacts); ++c) {
    const GrainContact<D>& contact = problem.contacts[at(c)];
    set_component<D>(r, c, {contact.impulse.n + contact.pull, contact.impulse.t});
  }
  return r;
}

// Solves the problem `held` of the contacts of a step. `start`: of the time that counts.
template <int D, ContactProblem Problem>
void solve(GranularStep<D>& step, Problem& held, Clock::time_point start, const Simulation& simulation,
           const IterationSink& sink) {
  const StepSolver& solver = simulation.dynamics.solver;
  const StepProblem<D>& problem = step.problem;
  StepReport& report = step.report;
  // r^1 assumes r = 0 at the other contacts; with r + pull = 0 their pulls would act.
  if (problem.pulls) held.data.alone = std::sqrt(report.residual.scale.alone);
  const auto take = [&](const Vector& shifted) {
    step.contacts = problem.contacts;
    for (std::size_t c = 0; c < step.contacts.size(); ++c) {
      step.contacts[c].impulse = component<D>(shifted, static_cast<Index>(c));
      step.contacts[c].impulse.n -= step.contacts[c].pull;
    }
    if constexpr (std::is_same_v<Problem, DividedContacts<D>>) {
      step.velocities = held.velocities(shifted);
      report.interface_iterations = held.work().iterations;
    } else {
      step.velocities = velocities_of(problem, step.contacts);
    }
    report.residual = residual_of(step, simulation.processes);
  };
  Vector pulls = Vector::Zero(D * count(problem.contacts));
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) pulls[D * static_cast<Index>(c)] = problem.contacts[c].pull;
  std::vector<ContactStatus> statuses;
  double observing = 0;  // s, for the indicators
  const auto seconds = [&] { return seconds_since(start) - observing; };
  const auto observe = [&](const Vector& shifted) {
    const double before = seconds();
    take(shifted);
    std::vector<ContactStatus> now;
    for (const GrainContact<D>& contact : step.contacts) now.push_back(status_of(problem.law, contact));
    const Index changes = changes_of(statuses, std::move(now));
    sink.row({.step = simulation.state.step + 1,
              .record = report.last,
              .residual = report.residual,
              .status_changes = simulation.processes.sum(changes),
              .factorisations = report.factorisations,
              .interface_iterations = report.interface_iterations,
              .seconds = before});
    observing += seconds() - before;
  };
  const auto observer = [&](const FrictionSolution& check) {
    report.last = {.iteration = report.last.iteration + 1, .sweeps = check.sweeps, .zeta = not_a_number};
    report.factorisations = check.factorisations;
    if (sink.observes(report.last.iteration)) observe(check.impulses);
    return !sink.goes_on || sink.goes_on();
  };
  const FrictionSolverOptions options{.algorithm = contact_solver_of(solver.algorithm).value(),
                                      .tolerance = solver.tolerance,
                                      .maximum_sweeps = 100 * solver.maximum_iterations,
                                      .maximum_factorisations = solver.maximum_iterations,
                                      .relaxation = solver.contact_relaxation};
  const FrictionSolution solution = solve_contacts(held, options, shifted_impulses(problem), observer);
  report.solve_seconds = seconds();
  report.factorisations = solution.factorisations;
  if (sink.row && !sink.observes(report.last.iteration)) observe(solution.impulses);
  // The first six values of both enumerations correspond one to one.
  static_assert(static_cast<int>(FrictionStatus::stopped) == static_cast<int>(SolverStatus::given_up));
  report.status = static_cast<SolverStatus>(solution.status);
  report.doubtful = report.status == SolverStatus::converged && !solution.credible;
  report.last.impulses = held.data.sums.squared_norm(solution.impulses - pulls);
  take(solution.impulses);
}

}  // namespace

ContactColours contact_colours(const Simulation& simulation, const std::vector<StepContact>& contacts) {
  ContactColours colours{std::vector<Index>(contacts.size()), 0};
  const GranularSystem& system = simulation.system;
  GreedyColours taken(system.bodies());
  std::vector<Index> ends;
  for_each_step_contact(start_of(simulation), [&](const StepContact& contact) {
    ends.clear();
    for (const Index end : {system.node_of(contact.a), system.node_of(contact.b)})
      if (system.is_free_node(end)) ends.push_back(end);
    const Index colour = taken.take_least(ends, ends);
    colours.number = std::max(colours.number, colour + 1);
    const auto found = std::ranges::lower_bound(contacts, body_pair(contact), {}, body_pair);
    if (found != contacts.end() && body_pair(*found) == body_pair(contact))
      colours.of_contact[at(found - contacts.begin())] = colour;
  });
  return colours;
}

template <int D>
void solve_whole_contacts(GranularStep<D>& step, const Simulation& simulation, const IterationSink& sink) {
  const auto start = Clock::now();
  step.report.residual.scale = GranularDecomposition<D>::scale_of(step.problem, step.partition, simulation.processes);
  const LocalFrictionProblem whole = contact_problem(step.problem, simulation.system);
  StoredContacts<D> stored(whole);
  solve(step, stored, start, simulation, sink);
}

template <int D>
void solve_divided_contacts(GranularStep<D>& step, GranularDecomposition<D> parts, const Simulation& simulation,
                            const IterationSink& sink) {
  const auto start = Clock::now();
  const StepSolver& solver = simulation.dynamics.solver;
  const bool admm = contact_solver_of(solver.algorithm) == FrictionAlgorithm::admm;
  check(solver);
  // Solutions of Newton's steps are refined: their errors are about the square of the tolerance.
  const double tolerance = admm ? std::min(1e-8, solver.tolerance) : std::min(1e-4, 1e4 * solver.tolerance);
  std::optional<CutContacts<D>> cut;
  if (has_part(solver.algorithm, StepPart::cut_systems)) {
    Decomposition linear = linear_decomposition(simulation, step);
    if (solver.coarse_space == CoarseSpace::rigid) add_places(linear, simulation);
    cut.emplace(std::move(linear), CutOptions{.preconditioner = solver.interface_preconditioner,
                                              .flexibility = admm ? 1 : solver.interface_flexibility,
                                              .tolerance = tolerance,
                                              .scaling = solver.interface_scaling,
                                              .coarse_space = solver.coarse_space,
                                              .kappa = solver.coarse_kappa,
                                              .period = simulation.system.period,
                                              .inertia = simulation.inertia,
                                              .bddc = simulation.bddc});
  }
  DividedContacts<D> divided(step.problem, step.partition, std::move(parts),
                             contact_colours(simulation, step.problem.geometry), std::move(cut),
                             admm ? Refinement::none : Refinement::one_step);
  solve(step, divided, start, simulation, sink);
  divided.take_operations();
  const auto work = divided.work();
  WorkCount& counts = *simulation.processes.counts;
  counts.flops += work.flops;
  counts.path_flops += work.path_flops;
  step.report.interface_systems = work.solves;
}

template void solve_whole_contacts(GranularStep<2>&, const Simulation&, const IterationSink&);
template void solve_divided_contacts(GranularStep<2>&, GranularDecomposition<2>, const Simulation&,
                                     const IterationSink&);
template void solve_whole_contacts(GranularStep<3>&, const Simulation&, const IterationSink&);
template void solve_divided_contacts(GranularStep<3>&, GranularDecomposition<3>, const Simulation&,
                                     const IterationSink&);

}  // namespace nscdd
