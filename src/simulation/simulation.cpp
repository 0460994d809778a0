// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/simulation.hpp"

#include "simulation/step_decomposition.hpp"
#include "simulation/undivided_step.hpp"

#include <fmt/ranges.h>

#include <chrono>

namespace nscdd {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Contacts dissipate. Only driven bodies bring energy, which hand on their speed at most twice over, and pushes: a
// contact whose bodies overlap does the work r_n times the speed at which it pushes them apart. (Speeds of pushes add
// up along a chain of overlaps, but so do the impulses.) A step that ends with so many times as much energy as all of
// these went wrong, even after few iterations.
constexpr double energy_explosion = 10;

template <int D>
double kinetic_energy(const std::vector<GrainVelocity<D>>& velocities) {
  double sum = 0;
  for (const GrainVelocity<D>& v : velocities)
    if (v.inverse_mass > 0) sum += kinetic_energy(v);
  return sum;
}

// `contacts`: with their impulses.
template <int D>
bool energy_exploded(const StepProblem<D>& problem, const std::vector<GrainContact<D>>& contacts,
                     const std::vector<GrainVelocity<D>>& velocities) {
  double mass = 0, speed_squared = 0;  // of all free grains; of the fastest driven body or push
  for (const GrainVelocity<D>& v : problem.start) {
    if (v.inverse_mass > 0) mass += 1 / v.inverse_mass;
    if (v.inverse_mass == 0) speed_squared = std::max(speed_squared, squared_velocity(v) + squared_rim(v));
  }
  double pushes = 0;
  for (const GrainContact<D>& c : contacts) {
    speed_squared = std::max(speed_squared, squared(c.bias));
    pushes += c.impulse.n * std::max(0.0, -c.bias.n);
  }
  const double reference =
      kinetic_energy(problem.start) + kinetic_energy(problem.free) + mass * speed_squared / 2 + pushes;
  return reference > 0 && kinetic_energy(velocities) > energy_explosion * reference;
}

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
    if (simulation.state.step == 0) throw;
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
PreparedStep<D> prepare_solution(const Simulation& simulation) {
  const Dynamics& dynamics = simulation.dynamics;
  const StepSolver& solver = dynamics.solver;
  if (!simulation.processes.alone() && (!decomposes(solver.algorithm) || switches_models(simulation)))
    throw Error("processes: expected an algorithm that decomposes where several of them share a step, met another");
  auto [problem, partition, parts] = simulation.processes.together([&] {
    StepProblem<D> whole = checked_problem<D>(simulation);
    Partition of_contacts = partition_step(simulation, whole);
    const auto seed = static_cast<std::uint64_t>(solver.seed + simulation.state.step);
    GranularDecomposition<D> own = decompose(whole, of_contacts, solver.order, seed, simulation.processes);
    return std::tuple(std::move(whole), std::move(of_contacts), std::move(own));
  });
  StepReport report{.interface_size = parts.interface_size(), .scale = problem.scale};
  std::optional<InterfaceOperator> enriched;
  if (solver.algorithm == StepAlgorithm::enriched && parts.interface_size() > 0) {
    report.eta =
        solver.eta.optimal ? best_eta(simulation, problem, partition) : solver.eta.value.at_scale(problem.scale);
    enriched = enriched_operator(simulation, problem, partition, report.eta);
  }
  GranularTwoStage<D> iteration(std::move(parts), problem.law, solver, enriched);
  iteration.start(solver.warm_start ? simulation.state.gluing : std::vector<RememberedGluing>{});
  if (switches_models(simulation)) {
    typename GranularTwoStage<D>::Grains grains{{}, simulation.system.radius};
    for (std::size_t i = 0; i < at(simulation.system.disks()); ++i)
      grains.centre.push_back({simulation.state.x[i], simulation.state.y[i]});
    iteration.switch_models(solver.warm_start ? simulation.state.models : std::vector<RememberedModel>{}, problem.scale,
                            grains);
  }
  return {std::move(problem), std::move(partition), std::move(enriched), report, std::move(iteration)};
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
    if (look)
      sink.row({.step = simulation.state.step + 1,
                .record = report.last,
                .residual = report.residual,
                .status_changes = changes_of(statuses, iteration.statuses()),
                .seconds = report.solve_seconds});
  }
  report.status = *status;
  report.residual = iteration.residual();
  simulation.processes.counts->contact_updates += static_cast<double>(iteration.contact_updates());
  auto [contacts, velocities] = iteration.gather(step.problem);
  step.contacts = std::move(contacts);
  step.velocities = std::move(velocities);
  if (report.interface_size > 0) {  // of the velocities that are kept, not of copies that may still differ
    const double scale = report.residual.impulses;
    report.residual = contact_residual(step.problem.law, step.contacts, step.velocities);
    report.residual.impulses = scale;
  }
  step.gluing = iteration.gluing();
  step.models = iteration.models();
  step.interface_impulses = iteration.interface_impulses();
}

}  // namespace

template <int D>
SolvedStep<D> solve_step(const Simulation& simulation, const IterationSink& sink) {
  const auto begin = Clock::now();
  PreparedStep<D> prepared = prepare_solution<D>(simulation);
  SolvedStep<D> step;
  step.problem = std::move(prepared.problem);
  step.partition = std::move(prepared.partition);
  StepReport& report = step.report = prepared.report;
  report.setup_seconds = seconds_since(begin);
  if (is_contact_solver(simulation.dynamics.solver.algorithm))
    solve_undivided(step, simulation, sink);
  else
    iterate(step, prepared.iteration, simulation, sink);
  if (report.status == SolverStatus::given_up) return step;
  // A law opens a contact whose velocity is not finite. Its impulse is then 0, and the indicators may look well.
  if (!std::ranges::all_of(step.velocities, is_finite<D>))
    report.status = SolverStatus::no_number;
  else if ((step.energy_exploded = energy_exploded(step.problem, step.contacts, step.velocities)))
    report.status = SolverStatus::diverged;
  report.step = simulation.state.step + 1;
  report.contacts = count(step.contacts);
  report.overlap = interpenetration(simulation.system, step.problem.geometry);
  return step;
}

StepReport solved_report(const Simulation& simulation, const IterationSink& sink) {
  return in_dimension(simulation.system,
                      [&](auto dimension) { return solve_step<dimension()>(simulation, sink).report; });
}

template <int D>
StepReport take_step(Simulation& simulation, const SolvedStep<D>& step) {
  StepReport report = step.report;
  report.energy = finish_step(simulation.system, simulation.state, step.problem, simulation.dynamics.time,
                              step.contacts, step.velocities);
  GranularState& state = simulation.state;
  if (decomposes_afresh(simulation, report.step - 1)) {
    state.decomposed_at = report.step - 1;
    state.eta = std::isnan(report.eta) ? 0 : report.eta;
  }
  state.gluing = step.gluing;
  state.models = step.models;
  state.subdomains.clear();
  for (std::size_t k = 0; k < step.problem.geometry.size(); ++k)
    state.subdomains.push_back(
        {step.problem.geometry[k].a, step.problem.geometry[k].b, step.partition.subdomain_of_contact[k]});
  report.time = state.time;
  return report;
}

template <int D>
std::string describe_breakdown(const Simulation& before, const SolvedStep<D>& step) {
  const auto place = [](const auto& point) { return fmt::format("({:.6g}) m", fmt::join(point, ", ")); };
  const auto name = [&](auto contact) {
    const StepContact& c = step.problem.geometry[at(contact - step.contacts.begin())];
    return fmt::format("contact of {} and {} at {}", body_name(before.system, c.a), body_name(before.system, c.b),
                       place(std::span(c.point).first(D)));
  };
  const auto impulse = [](const GrainContact<D>& c) { return std::hypot(c.impulse.n, norm(c.impulse.t)); };
  const auto wrong = std::ranges::find_if_not(
      step.contacts, [](double size) { return std::isfinite(size); }, impulse);
  if (wrong != step.contacts.end()) return name(wrong) + ": the impulse is not finite";
  for (std::size_t i = 0; i < step.velocities.size(); ++i)
    if (!is_finite(step.velocities[i]))
      return fmt::format("{}{}: the velocity is not finite", body_name(before.system, static_cast<Index>(i)),
                         i < before.state.x.size() ? " at " + place(centre_of<D>(before.state, i)) : "");
  if (step.contacts.empty()) return "no contact";
  const auto largest = std::ranges::max_element(step.contacts, {}, impulse);
  return fmt::format("{}: largest impulse, {:.6g} N s", name(largest), impulse(*largest));
}

double mean_speed(const GranularSystem& system, double kinetic_energy) {
  double mass = 0;
  for (Index i = 0; i < system.disks(); ++i)
    if (system.free(i)) mass += system.mass[at(i)];
  return std::sqrt(2 * kinetic_energy / mass);
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
    const StepReport report = std::visit([&](const auto& step) { return take_step(simulation, step); }, *solved);
    if (sinks.step) sinks.step(simulation, *solved, report);
    speeds.push_back(mean_speed(simulation.system, report.energy.kinetic));
    if (!nscdd::report(sinks.monitor, simulation.state.step, time.steps)) return {RunEnd::stopped};
  }
  return {at_rest(speeds, time.rest_speed) ? RunEnd::at_rest : RunEnd::completed};
}

template PreparedStep<2> prepare_solution(const Simulation&);
template SolvedStep<2> solve_step(const Simulation&, const IterationSink&);
template StepReport take_step(Simulation&, const SolvedStep<2>&);
template std::string describe_breakdown(const Simulation&, const SolvedStep<2>&);
template PreparedStep<3> prepare_solution(const Simulation&);
template SolvedStep<3> solve_step(const Simulation&, const IterationSink&);
template StepReport take_step(Simulation&, const SolvedStep<3>&);
template std::string describe_breakdown(const Simulation&, const SolvedStep<3>&);

}  // namespace nscdd
