// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/case/lead_in.hpp"

#include "core/fail.hpp"

namespace nscdd {
namespace {

StepSolver plain_solver() {
  return {.algorithm = StepAlgorithm::nlgs,
          .maximum_iterations = 2000,
          .criterion = Criterion::zeta,
          .tolerance = 1e-6,
          .order = ContactOrder::interleaved,
          .warm_start = true,
          .eta = {}};
}

void advance(Arrival& arrival) {
  arrival.totals.add(in_dimension(arrival.simulation.system, [&](auto dimension) {
    const auto step = solve_step<dimension()>(arrival.simulation);
    if (step.report.broke_down())
      fail("step {}: {}: {}", step.report.step, to_string(step.report.status),
           describe_breakdown(arrival.simulation, step));
    return take_step(arrival.simulation, step);
  }));
}

}  // namespace

void RunTotals::add(const StepReport& report) {
  ++steps;
  ++statuses[to_string(report.status)];
  converged += report.status == SolverStatus::converged;
  iterations += report.last.iteration;
  most_iterations = std::max(most_iterations, report.last.iteration);
  if (report.residual.relative_natural_map() >= natural_map) worst_step = report.step;
  natural_map = std::max(natural_map, report.residual.relative_natural_map());
  gluing = std::max(gluing, report.last.gluing);
  overlap = std::max(overlap, report.overlap.maximum);
  relative_overlap = std::max(relative_overlap, report.overlap.relative);
  interface = interface || report.interface_size > 0;
  most_copies = std::max(most_copies, report.most_copies);
  boundary_work += report.energy.boundary_work;
  dissipation += report.energy.dissipation;
  numerical += report.energy.numerical;
  gain += std::max(0.0, -report.energy.dissipation);
  gaining_steps += report.energy.dissipation < 0;
  contact_energy += report.residual.scale_work;
  if (report.verdict) ++verdicts[to_string(*report.verdict)];
  if (report.verdict) margin = std::min(margin, report.margin);
  if (report.no_room && report.verdict != VerdictKind::exists && no_room++ == 0) first_no_room = report.step;
  doubtful += report.doubtful;
  setup_seconds += report.setup_seconds;
  solve_seconds += report.solve_seconds;
  visits += static_cast<double>(report.contacts) * static_cast<double>(report.last.sweeps);
  last = report;
}

Arrival LeadIn::at(const Case& one, Index steps, LeadInSolver solver) {
  check_dynamics(one.spec);
  const StepSolver of_case = one.spec.dynamics->solver;
  const StepSolver used = solver == LeadInSolver::own ? of_case : plain_solver();
  CaseSpec spec = one.spec;
  spec.dynamics->solver = used;
  spec.dynamics->time.steps = 0;
  std::map<Index, Arrival>& kept = known_[text_with_contents(one, spec)];
  if (kept.empty()) kept.emplace(0, Arrival{simulation_of(one), {}});
  Arrival arrival = std::prev(kept.upper_bound(steps))->second;
  arrival.simulation.dynamics.solver = used;
  while (arrival.simulation.state.step < steps) advance(arrival);
  kept.insert_or_assign(steps, arrival);
  arrival.simulation.dynamics.solver = of_case;
  return arrival;
}

template <int D>
GranularStep<D> next_step(Simulation simulation, LeadInSolver solver) {
  StepSolver decomposing = simulation.dynamics.solver;
  if (!decomposes(decomposing.algorithm)) decomposing.algorithm = StepAlgorithm::generic;
  if (solver == LeadInSolver::plain) simulation.dynamics.solver = plain_solver();
  GranularStep<D> step = solve_step<D>(simulation);
  simulation.dynamics.solver = std::move(decomposing);
  step.partition = partition_step(simulation, step.problem.geometry);
  return step;
}
template GranularStep<2> next_step(Simulation, LeadInSolver);
template GranularStep<3> next_step(Simulation, LeadInSolver);

}  // namespace nscdd
