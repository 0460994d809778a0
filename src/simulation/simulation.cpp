// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/simulation.hpp"

#include "core/memory.hpp"
#include "simulation/contact_solver_step.hpp"
#include "simulation/room.hpp"
#include "simulation/step_decomposition.hpp"

#include <fmt/format.h>

#include <chrono>

namespace nscdd {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// The next step; if there is none, `reason` says why.
template <int D>
std::optional<AnySolvedStep> solve_or_explain(const Simulation& simulation, const IterationSink& sink,
                                              std::string& reason) {
  try {
    SolvedStep<D> step = solve_step<D>(simulation, sink);
    if (!step.report.broke_down()) return step;
    const auto ended = step.energy_exploded ? "more energy than loads, boundaries and pushes can bring"
                                            : to_string(step.report.status);
    reason = fmt::format("step {}: {} after {} iterations, {}", step.report.step, ended, step.report.last.iteration,
                         describe_breakdown(simulation, step));
  } catch (const Error& error) {
    // A rank that has no memory ends the run: the others may wait for it inside the solver.
    const bool refused_alone = dynamic_cast<const OutOfMemory*>(&error) != nullptr && !simulation.processes.alone();
    if (simulation.state.step == 0 || refused_alone) throw;
    reason = fmt::format("step {}: {}", simulation.state.step + 1, error.what());
  }
  return std::nullopt;
}

// Whether grains rest: they were slow for `rest_steps` steps, and not faster at each step, which is how a fall begins.
bool at_rest(const std::vector<double>& speeds, double rest_speed) {
  if (count(speeds) < rest_steps) return false;
  const auto last = std::span(speeds).last(at(rest_steps));
  return std::ranges::all_of(last, [&](double speed) { return speed < rest_speed; }) &&
         std::ranges::adjacent_find(last, std::ranges::greater_equal()) != last.end();
}

}  // namespace

template <int D>
DividedStep<D> divide_step(const Simulation& simulation) {
  return simulation.processes.together([&] {
    const StepSolver& solver = simulation.dynamics.solver;
    const auto seed = static_cast<std::uint64_t>(solver.seed + simulation.state.step);
    auto [problem, partition, share, report] = share_step<D>(simulation);
    auto parts = decompose(problem, partition, solver.order, seed, share.process_of_subdomain, simulation.processes);
    report.interface_size = parts.interface_size();
    report.residual.scale = parts.scale;
    return DividedStep<D>{std::move(problem), std::move(partition), std::move(share), report, std::move(parts)};
  });
}

template <int D>
PreparedStep<D> prepare_solution(const Simulation& simulation) {
  const StepSolver& solver = simulation.dynamics.solver;
  auto [problem, partition, share, report, parts] = divide_step<D>(simulation);
  std::optional<InterfaceOperator> enriched;
  if (has_part(solver.algorithm, StepPart::enriched_stage_two) && parts.interface_size() > 0) {
    report.eta =
        solver.eta.optimal ? best_eta(simulation, problem, partition, share) : solver.eta.value.at_scale(problem.scale);
    enriched = enriched_operator(simulation, problem, partition, report.eta, share);
  }
  GranularTwoStage<D> iteration(std::move(parts), problem.law, solver, enriched);
  iteration.start(solver.warm_start ? simulation.state.gluing : std::vector<RememberedGluing>{});
  if (switches_models(simulation)) iteration.switch_models(simulation.system, simulation.state, problem.scale);
  return {std::move(problem),  std::move(partition), std::move(share), std::move(enriched), report,
          std::move(iteration)};
}

namespace {

// The iterations of a prepared step, until they end.
template <int D>
void iterate(SolvedStep<D>& step, GranularTwoStage<D>& iteration, const Simulation& simulation,
             const IterationSink& sink) {
  const StepSolver& solver = simulation.dynamics.solver;
  StepReport& report = step.report;
  IterationWatch watch(solver);
  std::vector<ContactStatus> statuses;
  std::optional<SolverStatus> status;
  for (Index k = 1; !status; ++k) {
    const auto start = Clock::now();
    iteration.iterate();
    bool look = sink.looks_at(k);
    const bool judged = watch.looks_at(k);
    if (look || judged) report.last = iteration.record();
    report.solve_seconds += seconds_since(start);
    if (look || (judged && needs_residual(solver.criterion))) report.residual = iteration.residual();
    if (judged) status = watch.judge(report.last, report.residual);
    if (sink.goes_on && !sink.goes_on()) {
      report.status = SolverStatus::given_up;
      return;
    }
    if (status && sink.row && !look) {
      look = true;
      report.residual = iteration.residual();
    }
    if (!look) continue;
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
  if (report.interface_size > 0) {  // of the velocities that are kept, not of copies that may still differ
    const ContactResidual of_copies = report.residual;
    report.residual =
        residual_of_subdomains(step.problem.law, step.partition, step.contacts, step.velocities, simulation.processes);
    report.residual.impulses = of_copies.impulses;
    report.residual.scale = of_copies.scale;
  }
  step.gluing = iteration.gluing();
  step.models = iteration.models();
  step.interface_impulses = iteration.interface_impulses();
}

}  // namespace

template <int D>
SolvedStep<D> solve_step(const Simulation& simulation, const IterationSink& sink) {
  const auto begin = Clock::now();
  SolvedStep<D> step;
  StepReport& report = step.report;
  const auto take = [&](auto& prepared) {
    step.problem = std::move(prepared.problem);
    step.partition = std::move(prepared.partition);
    step.share = std::move(prepared.share);
    report = prepared.report;
    report.setup_seconds = seconds_since(begin);
  };
  const auto& algorithm = simulation.dynamics.solver.algorithm;
  if (!is_contact_solver(algorithm)) {
    PreparedStep<D> prepared = prepare_solution<D>(simulation);
    step.shared_grains = shared_grains(prepared.iteration.parts().interface);
    take(prepared);
    iterate(step, prepared.iteration, simulation, sink);
  } else if (decomposes(algorithm)) {
    DividedStep<D> prepared = divide_step<D>(simulation);
    step.shared_grains = shared_grains(prepared.parts.interface);
    take(prepared);
    solve_divided_contacts(step, std::move(prepared.parts), simulation, sink);
  } else {
    StepShare<D> prepared = share_step<D>(simulation);
    take(prepared);
    solve_whole_contacts(step, simulation, sink);
  }
  if (report.status == SolverStatus::given_up) return step;
  const Processes& all = simulation.processes;
  step.all_grains = velocities_of_grains(simulation, step.problem, step.velocities, all);
  const Vector sums = sums_over_contacts(step.partition, 6, all, [&](Index k, auto&& sum) {
    const GrainContact<D>& c = step.contacts[at(k)];
    const ContactWork work = work_of(step.problem, c, step.velocities);
    sum[0] += work.boundary;
    sum[1] += work.dissipation;
    sum[2] += c.impulse.n * std::max(0.0, -c.bias.n);
    sum[3] += std::max(0.0, -step.problem.geometry[at(k)].gap);
    sum[4] += step.problem.geometry[at(k)].gap < 0;
    sum[5] += c.impulse.n * std::max(0.0, -relative_velocity<D>(c, step.velocities).n - c.bias.n);
  });
  step.work = {sums[0], sums[1]};
  report.overlap = interpenetration(simulation.system, step.problem.geometry);
  report.overlap = {.maximum = all.maximum(report.overlap.maximum),
                    .mean = sums[3] / std::max(1.0, sums[4]),
                    .relative = all.maximum(report.overlap.relative)};
  // A law opens a contact whose velocity is not finite. Its impulse is then 0, and the indicators may look well.
  const auto finite = [](const GrainMotion& v) {
    return std::ranges::all_of(v, [](double one) { return std::isfinite(one); });
  };
  if (!std::ranges::all_of(step.all_grains, finite)) report.status = SolverStatus::no_number;
  const StepRoom room = room_of(simulation, step, sums[2], sums[5]);
  step.energy_exploded = report.status != SolverStatus::no_number && energy_exploded(room);
  if (step.energy_exploded) report.status = SolverStatus::diverged;
  report.no_room = no_room(room, report.residual);
  report.step = simulation.state.step + 1;
  return step;
}

StepReport solved_report(const Simulation& simulation, const IterationSink& sink) {
  return in_dimension(simulation.system,
                      [&](auto dimension) { return solve_step<dimension()>(simulation, sink).report; });
}

template <int D>
StepReport take_step(Simulation& simulation, const SolvedStep<D>& step) {
  StepReport report = step.report;
  GranularState& state = simulation.state;
  check_end_of_step(start_of(simulation), step.all_grains);
  report.energy = finish_step(simulation.system, state, simulation.dynamics.time, step.all_grains, step.work);
  state.impulses = impulses_to_remember(step.problem, step.contacts);
  if (decomposes_afresh(simulation, report.step - 1)) {
    state.decomposed_at = report.step - 1;
    state.eta = std::isnan(report.eta) ? 0 : report.eta;
  }
  state.gluing = step.gluing;
  state.models = step.models;
  state.process_of_subdomain = step.share.process_of_subdomain;
  state.subdomains = subdomains_to_remember(step.problem, step.partition, step.shared_grains, simulation.processes);
  report.time = state.time;
  return report;
}

namespace {

// What is known of a step that is taken; if grains would pass each other before its end, `reason` says so.
std::optional<StepReport> take_or_explain(Simulation& simulation, const AnySolvedStep& solved, std::string& reason) {
  try {
    return std::visit([&](const auto& step) { return take_step(simulation, step); }, solved);
  } catch (const Error& error) {
    reason = fmt::format("step {}: {}", simulation.state.step + 1, error.what());
    return std::nullopt;
  }
}

}  // namespace

double mean_speed(const GranularSystem& system, double kinetic_energy) {
  double mass = 0;
  for (Index i = 0; i < system.grains(); ++i)
    if (system.free(i)) mass += system.mass[at(i)];
  return mass == 0 ? 0.0 : std::sqrt(2 * kinetic_energy / mass);
}

RunOutcome run_simulation(Simulation& simulation, const RunSinks& sinks, std::vector<double> speeds) {
  const TimeStepping time = simulation.dynamics.time;
  while (simulation.state.step < time.steps && !at_rest(speeds, time.rest_speed)) {
    std::string reason;
    const std::optional<AnySolvedStep> solved = in_dimension(simulation.system, [&](auto dimension) {
      return solve_or_explain<dimension()>(simulation, sinks.iteration, reason);
    });
    if (!solved) return {RunEnd::broke_down, reason};
    if (std::visit([](const auto& step) { return step.report.status; }, *solved) == SolverStatus::given_up)
      return {RunEnd::stopped};
    const std::optional<StepReport> report = take_or_explain(simulation, *solved, reason);
    if (!report) return {RunEnd::broke_down, reason};
    if (sinks.step) sinks.step(simulation, *solved, *report);
    speeds.push_back(mean_speed(simulation.system, report->energy.kinetic));
    if (!nscdd::report(sinks.monitor, simulation.state.step, time.steps)) return {RunEnd::stopped};
  }
  return {at_rest(speeds, time.rest_speed) ? RunEnd::at_rest : RunEnd::completed};
}

template DividedStep<2> divide_step(const Simulation&);
template PreparedStep<2> prepare_solution(const Simulation&);
template SolvedStep<2> solve_step(const Simulation&, const IterationSink&);
template StepReport take_step(Simulation&, const SolvedStep<2>&);
template DividedStep<3> divide_step(const Simulation&);
template PreparedStep<3> prepare_solution(const Simulation&);
template SolvedStep<3> solve_step(const Simulation&, const IterationSink&);
template StepReport take_step(Simulation&, const SolvedStep<3>&);

}  // namespace nscdd
