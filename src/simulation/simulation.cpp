// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/simulation.hpp"

#include "core/memory.hpp"
#include "simulation/contact_solver_step.hpp"
#include "simulation/step_decomposition.hpp"

#include <fmt/format.h>

namespace nscdd {
namespace {

// Whether grains were slow for `rest_steps` steps, and not faster at each step, as when a fall begins.
bool at_rest(const std::vector<double>& speeds, double rest_speed) {
  constexpr double unseen = 1e-6;  // a rise of the speed by rounding
  if (count(speeds) < rest_steps) return false;
  const auto last = std::span(speeds).last(at(rest_steps));
  return std::ranges::all_of(last, [&](double speed) { return speed < rest_speed; }) &&
         std::ranges::adjacent_find(last, [&](double one, double next) { return next <= one + unseen * rest_speed; }) !=
             last.end();
}

template <int D>
void iterate(GranularStep<D>& step, GranularTwoStage<D>& iteration, const Simulation& simulation,
             const IterationSink& sink) {
  const StepSolver& solver = simulation.dynamics.solver;
  StepReport& report = step.report;
  IterationWatch watch(solver);
  std::vector<ContactStatus> statuses;
  std::optional<SolverStatus> status;
  for (Index k = 1; !status; ++k) {
    bool observed = sink.observes(k);
    const bool judged = watch.judges(k);
    // The last iteration, which always has a row, is one of those judged.
    const bool measured = observed || (judged && (sink.row || watch.needs_normal_change()));
    if (measured) iteration.remember_impulses();
    const auto start = Clock::now();
    iteration.iterate();
    if (observed || judged) report.last = iteration.record();
    report.solve_seconds += seconds_since(start);
    if (measured) report.last.normal_change = iteration.normal_change();
    if (observed || (judged && watch.needs_residual())) report.residual = iteration.residual();
    if (judged) status = watch.judge(report.last, report.residual);
    if (sink.goes_on && !sink.goes_on()) {
      report.status = SolverStatus::given_up;
      return;
    }
    if (status && sink.row && !observed) {
      observed = true;
      report.residual = iteration.residual();
    }
    if (!observed) continue;
    const Index changes = changes_of(statuses, iteration.statuses());
    sink.row({.step = simulation.state.step + 1,
              .record = report.last,
              .residual = report.residual,
              .status_changes = simulation.processes.sum(changes),
              .seconds = report.solve_seconds});
  }
  report.status = *status;
  report.residual = iteration.residual();
  simulation.processes.counts->contact_updates += static_cast<double>(iteration.contact_updates());
  auto [contacts, velocities] = iteration.gather(step.problem);
  step.contacts = std::move(contacts);
  step.velocities = std::move(velocities);
  if (report.interface_size > 0) {  // of the velocities that the state keeps: copies may still differ
    const double impulses = report.residual.impulses;
    report.residual = residual_of(step, simulation.processes);
    report.residual.impulses = impulses;
  }
  step.gluing = iteration.gluing();
  step.models = iteration.models();
  step.interface_impulses = iteration.interface_impulses();
}

template <int D>
GranularStep<D> solve_once(const Simulation& simulation, const IterationSink& sink) {
  const auto begin = Clock::now();
  GranularStep<D> step;
  const auto take = [&](GranularStep<D>&& prepared) {
    step = std::move(prepared);
    step.report.setup_seconds = seconds_since(begin);
  };
  const auto& algorithm = simulation.dynamics.solver.algorithm;
  if (!is_contact_solver(algorithm)) {
    PreparedStep<D> prepared = prepare_solution<D>(simulation);
    take(std::move(prepared.share));
    iterate(step, prepared.iteration, simulation, sink);
  } else if (decomposes(algorithm)) {
    auto [divided, parts] = divide_step<D>(simulation);
    take(std::move(divided));
    solve_divided_contacts(step, std::move(parts), simulation, sink);
  } else {
    take(share_step<D>(simulation));
    solve_whole_contacts(step, simulation, sink);
  }
  if (step.report.status != SolverStatus::given_up) finish_solution(step, simulation);
  return step;
}

// Whether a bond opens or slides in a solved step, on any rank.
template <int D>
bool bonds_part(const GranularStep<D>& step, const Simulation& simulation) {
  if (!simulation.system.pairs.bonds() || step.report.status == SolverStatus::given_up) return false;
  const double alert = alert_distance(simulation.system, simulation.dynamics.time);
  bool parts = false;
  for (std::size_t k = 0; k < step.contacts.size() && !parts; ++k)
    parts = bond_of(start_of(simulation), step.problem.geometry[k], alert) &&
            status_of(step.problem.law, step.contacts[k]) != ContactStatus::stick;
  return simulation.processes.any(parts);
}

// Adds the work of an earlier try at a step to that of a row or report with this record.
void count_also(const StepReport& earlier, auto& counted, IterationRecord& record) {
  record.iteration += earlier.last.iteration;
  record.sweeps += earlier.last.sweeps;
  counted.factorisations += earlier.factorisations;
  counted.interface_iterations += earlier.interface_iterations;
}

// Solves and takes the next step of a run. Returns how the run ended, if it did.
template <int D>
std::optional<RunOutcome> advance(Simulation& simulation, const RunSinks& sinks, std::vector<double>& speeds) {
  const auto broke_down = [step = simulation.state.step + 1](std::string_view reason) {
    return RunOutcome{RunEnd::broke_down, fmt::format("step {}: {}", step, reason)};
  };
  AnySolvedStep solved;
  try {
    GranularStep<D> step = solve_step<D>(simulation, sinks.iteration);
    const std::string no_solution = judge(step, simulation, sinks.iteration.goes_on);
    if (!no_solution.empty() && simulation.dynamics.solver.impossible == IfImpossible::stop)
      return RunOutcome{RunEnd::impossible, fmt::format("step {}: {}", step.report.step, no_solution),
                        std::move(step.report.chain)};
    if (step.report.broke_down())
      return broke_down(fmt::format("{} after {} iterations, {}{}{}",
                                    step.bond_parts        ? "a bond parts"
                                    : step.energy_exploded ? "more energy than loads, boundaries and pushes can bring"
                                                           : to_string(step.report.status),
                                    step.report.last.iteration, describe_breakdown(simulation, step),
                                    no_solution.empty() ? "" : "; ", no_solution));
    if (step.report.status == SolverStatus::given_up) return RunOutcome{RunEnd::stopped};
    solved = std::move(step);
  } catch (const Error& error) {
    // A rank without memory aborts the run: the others may wait for it inside the solver.
    const bool refused_alone = dynamic_cast<const OutOfMemory*>(&error) != nullptr && !simulation.processes.alone();
    if (simulation.state.step == 0 || refused_alone) throw;
    return broke_down(error.what());
  }
  StepReport report;
  try {
    report = take_step(simulation, std::get<GranularStep<D>>(solved));
  } catch (const Error& error) {  // grains would pass each other before its end
    return broke_down(error.what());
  }
  report.mean_speed = mean_speed(simulation.system, report.energy.kinetic);
  if (sinks.step) sinks.step(simulation, solved, report);
  speeds.push_back(report.mean_speed);
  if (nscdd::report(sinks.monitor, simulation.state.step, simulation.dynamics.time.steps)) return std::nullopt;
  return RunOutcome{RunEnd::stopped};
}

}  // namespace

template <int D>
std::pair<GranularStep<D>, GranularDecomposition<D>> divide_step(const Simulation& simulation) {
  return simulation.processes.together([&] {
    const StepSolver& solver = simulation.dynamics.solver;
    const auto seed = static_cast<std::uint64_t>(solver.seed + simulation.state.step);
    GranularStep<D> step = share_step<D>(simulation);
    auto parts = decompose(step.problem, step.partition, solver.order, seed, step.process_of_subdomain,
                           simulation.processes, copy_mass(solver));
    parts.interface.for_glued_grains([&](Index grain, Index, Index) {
      step.shared_grains.push_back(grain);
      step.report.most_copies = std::max(step.report.most_copies, parts.interface.multiplicity(grain));
    });
    step.report.interface_size = parts.interface.size();
    step.report.residual.scale = parts.scale;
    return std::pair(std::move(step), std::move(parts));
  });
}

template <int D>
PreparedStep<D> prepare_solution(const Simulation& simulation) {
  const StepSolver& solver = simulation.dynamics.solver;
  auto [step, parts] = divide_step<D>(simulation);
  const StepProblem<D>& problem = step.problem;
  std::optional<InterfaceOperator> enriched;
  if (has_part(solver.algorithm, StepPart::enriched_stage_two) && parts.interface_size() > 0) {
    step.report.eta = solver.eta.optimal ? best_eta(simulation, step) : solver.eta.value.at_scale(problem.scale);
    enriched = enriched_operator(simulation, step, step.report.eta);
  }
  GranularTwoStage<D> iteration(std::move(parts), problem.law, solver, enriched);
  iteration.start(solver.warm_start ? simulation.state.gluing : std::vector<RememberedGluing>{});
  if (switches_models(simulation)) iteration.switch_models(simulation.system, simulation.state, problem.scale);
  return {std::move(step), std::move(enriched), std::move(iteration)};
}

template <int D>
GranularStep<D> solve_step(const Simulation& simulation, const IterationSink& sink) {
  constexpr double stronger_by = 10, strongest = 1e7;
  GranularStep<D> step = solve_once<D>(simulation, sink);
  if (!bonds_part(step, simulation)) return step;
  Simulation stronger = simulation;
  double& strength = stronger.dynamics.interaction.bond_strength;
  while (step.report.status == SolverStatus::converged && strength < strongest && bonds_part(step, stronger)) {
    strength *= stronger_by;
    const StepReport before = step.report;
    IterationSink further = sink;
    if (sink.row)
      further.row = [&](IterationRow row) {
        count_also(before, row, row.record);
        row.seconds += before.solve_seconds;
        sink.row(row);
      };
    step = solve_once<D>(stronger, further);
    count_also(before, step.report, step.report.last);
    step.report.setup_seconds += before.setup_seconds;
    step.report.solve_seconds += before.solve_seconds;
  }
  step.bond_parts = bonds_part(step, stronger);
  if (step.bond_parts) step.report.status = SolverStatus::diverged;
  return step;
}

StepReport solved_report(const Simulation& simulation, const IterationSink& sink) {
  return in_dimension(simulation.system,
                      [&](auto dimension) { return solve_step<dimension()>(simulation, sink).report; });
}

double mean_speed(const GranularSystem& system, double kinetic_energy) {
  double mass = 0;
  for (Index i = 0; i < system.grains(); ++i)
    if (system.free(i)) mass += system.mass[at(i)];
  for (const Index k : system.free_bodies) mass += system.boundaries[at(k)].body->mass;
  return mass == 0 ? 0.0 : std::sqrt(2 * kinetic_energy / mass);
}

RunOutcome run_simulation(Simulation& simulation, const RunSinks& sinks, std::vector<double> speeds) {
  const TimeStepping time = simulation.dynamics.time;
  while (simulation.state.step < time.steps && !at_rest(speeds, time.rest_speed)) {
    const auto ended = in_dimension(simulation.system,
                                    [&](auto dimension) { return advance<dimension()>(simulation, sinks, speeds); });
    if (ended) return *ended;
  }
  return {at_rest(speeds, time.rest_speed) ? RunEnd::at_rest : RunEnd::completed};
}

template std::pair<GranularStep<2>, GranularDecomposition<2>> divide_step(const Simulation&);
template std::pair<GranularStep<3>, GranularDecomposition<3>> divide_step(const Simulation&);
template PreparedStep<2> prepare_solution(const Simulation&);
template PreparedStep<3> prepare_solution(const Simulation&);
template GranularStep<2> solve_step(const Simulation&, const IterationSink&);
template GranularStep<3> solve_step(const Simulation&, const IterationSink&);

}  // namespace nscdd
