// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/study/simulation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace nscdd {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Without progress for this long, a criterion that rounding or cycling holds up will not fall any more.
constexpr Index patience = 1000;
constexpr double explosion = 1e6;

double criterion_value(const std::string& criterion, const IterationRecord& record,
                       const ContactResidual& residual) {
  if (criterion == "zeta") return record.zeta;
  if (criterion == "interface_change") return record.interface_change;
  if (criterion == "natural_map") return residual.relative_natural_map();
  if (criterion == "quad_dv") return residual.quad_dv();
  return infinity;  // none: as many iterations as allowed
}

bool needs_residual(const std::string& criterion) {
  return criterion == "natural_map" || criterion == "quad_dv";
}

// Status of every contact, subdomain by subdomain, and how many differ from the last call.
class StatusChanges {
 public:
  Index update(const GranularTwoStage& iteration, const ContactLaw& law) {
    Index changes = 0;
    std::size_t k = 0;
    for (const GranularSubdomain& subdomain : iteration.parts().subdomains)
      for (std::size_t c = 0; c < subdomain.contacts.size(); ++c) {
        const ContactStatus now = status_of(law, subdomain.contacts.contact(c, subdomain.velocities));
        if (k == statuses_.size()) statuses_.push_back(ContactStatus::open);
        changes += statuses_[k] != now;
        statuses_[k++] = now;
      }
    return changes;
  }

 private:
  std::vector<ContactStatus> statuses_;
};

// Decides when the iterations of a step end.
class Watch {
 public:
  explicit Watch(const StepSolver& solver) : solver_(&solver) {}

  std::optional<SolverStatus> judge(const IterationRecord& record, double value, double impulses) {
    if (!std::isfinite(impulses) || !std::isfinite(record.gluing)) return SolverStatus::no_number;
    if (record.iteration <= 10) first_impulses_ = std::max(first_impulses_, impulses);
    if (impulses > explosion * explosion * first_impulses_) return SolverStatus::diverged;
    if (value <= solver_->tolerance) return SolverStatus::converged;
    if (value < best_) {
      best_ = value;
      best_iteration_ = record.iteration;
    }
    if (record.iteration >= solver_->maximum_iterations) return SolverStatus::maximum_reached;
    if (value < infinity && record.iteration - best_iteration_ >= patience) return SolverStatus::stalled;
    return std::nullopt;
  }

 private:
  const StepSolver* solver_;
  double best_ = infinity, first_impulses_ = 0;
  Index best_iteration_ = 0;
};

ContactNetwork network_of(const StepProblem& problem, Index disks) {
  ContactNetwork network;
  network.grains = disks;
  for (const StepContact& c : problem.geometry)
    network.contacts.push_back({c.a, c.b, c.normal, c.point, c.gap});
  return network;
}

Packing free_grains(const GranularSystem& system, const GranularState& state) {
  Packing packing;
  for (Index i = 0; i < system.disks(); ++i) {
    if (!system.free(i)) continue;
    packing.x.push_back(state.x[at(i)]);
    packing.y.push_back(state.y[at(i)]);
    packing.radius.push_back(system.radius[at(i)]);
  }
  return packing;
}

// Normal directions only: METIS needs to know which contacts share a grain.
ReferenceProblem normal_problem(const StepProblem& problem, Index disks) {
  ReferenceProblem result = reference_problem(problem, disks);
  SparseMatrix h(result.h.rows(), count(problem.contacts));
  std::vector<Eigen::Triplet<double>> entries;
  for (Index c = 0; c < count(problem.contacts); ++c)
    for (SparseMatrix::InnerIterator e(result.h, 2 * c); e; ++e)
      entries.emplace_back(static_cast<int>(e.row()), static_cast<int>(c), e.value());
  h.setFromTriplets(entries.begin(), entries.end());
  result.h = std::move(h);
  return result;
}

// Contacts that carried an impulse in the last step: both directions where they stuck, the normal one where
// they slid. All of them where there is no step before.
std::vector<char> active_columns(const Simulation& simulation, const StepProblem& problem) {
  std::vector<char> kept(2 * problem.contacts.size(), simulation.state.impulses.empty() ? 1 : 0);
  auto old = simulation.state.impulses.begin();
  const auto end = simulation.state.impulses.end();
  const ContactLaw law = contact_law(simulation.dynamics.interaction, problem.h);
  for (std::size_t k = 0; k < problem.contacts.size(); ++k) {
    const auto key = std::pair(problem.geometry[k].a, problem.geometry[k].b);
    while (old != end && std::pair(old->a, old->b) < key) ++old;
    if (old == end) break;
    if (std::pair(old->a, old->b) != key) continue;
    DiskContact contact = problem.contacts[k];
    contact.impulse_n = old->impulse.n;
    contact.impulse_t = old->impulse.t;
    const ContactStatus status = status_of(law, contact);
    kept[2 * k] = status != ContactStatus::open;
    kept[2 * k + 1] = status == ContactStatus::stick;
  }
  return kept;
}

}  // namespace

std::string_view to_string(SolverStatus status) {
  switch (status) {
    case SolverStatus::converged:
      return "converged";
    case SolverStatus::stalled:
      return "stalled";
    case SolverStatus::maximum_reached:
      return "maximum_reached";
    case SolverStatus::diverged:
      return "diverged";
    case SolverStatus::no_number:
      return "no_number";
  }
  return "no_number";
}

Partition partition_step(const Simulation& simulation, const StepProblem& problem) {
  const Index disks = simulation.system.disks();
  if (simulation.dynamics.solver.algorithm == "nlgs")
    return {.subdomains = 1, .subdomain_of_contact = std::vector<Index>(problem.contacts.size(), 0)};
  if (const auto* metis = std::get_if<MetisPartitioner>(&simulation.partitioner))
    return by_metis(normal_problem(problem, disks), *metis);
  return by_grid(free_grains(simulation.system, simulation.state), network_of(problem, disks),
                 std::get<GridPartitioner>(simulation.partitioner));
}

InterfaceOperator enriched_operator(const Simulation& simulation, const StepProblem& problem,
                                    const Partition& partition, double eta) {
  const ReferenceProblem reference = reference_problem(problem, simulation.system.disks());
  const Decomposition all = decompose(reference, partition_of_columns(partition));
  if (simulation.dynamics.solver.network == "active")
    return InterfaceFamily(restrict_contacts(all, active_columns(simulation, problem))).at(eta);
  return InterfaceFamily(all).at(eta);
}

SolvedStep solve_step(const Simulation& simulation, const IterationSink& sink) {
  const Dynamics& dynamics = simulation.dynamics;
  const StepSolver& solver = dynamics.solver;
  const auto begin = Clock::now();
  SolvedStep step;
  step.problem = prepare_step(simulation.system, simulation.state, dynamics.interaction, dynamics.time,
                              solver.warm_start);
  step.partition = partition_step(simulation, step.problem);
  const ContactLaw law = contact_law(dynamics.interaction, step.problem.h);
  const auto seed = static_cast<std::uint64_t>(solver.seed + simulation.state.step);
  std::optional<InterfaceOperator> enriched;
  StepReport& report = step.report;
  GranularDecomposition parts = decompose(step.problem, step.partition, solver.order, seed);
  report.interface_size = parts.interface_size();
  if (solver.algorithm == "enriched" && parts.interface_size() > 0) {
    report.eta = parse_number(solver.eta, "solver.eta");
    enriched = enriched_operator(simulation, step.problem, step.partition, report.eta);
  }
  GranularTwoStage iteration(std::move(parts), law, solver, std::move(enriched));
  iteration.start(solver.warm_start ? simulation.state.gluing : std::vector<RememberedGluing>{});
  report.setup_seconds = seconds_since(begin);
  Watch watch(solver);
  StatusChanges statuses;
  for (;;) {
    const auto start = Clock::now();
    report.last = iteration.iterate();
    report.solve_seconds += seconds_since(start);
    const bool look = sink || needs_residual(solver.criterion);
    if (look) report.residual = iteration.residual();
    if (sink)
      sink({.step = simulation.state.step + 1,
            .record = report.last,
            .residual = report.residual,
            .status_changes = statuses.update(iteration, law),
            .seconds = report.solve_seconds});
    const double value = criterion_value(solver.criterion, report.last, report.residual);
    if (const auto status = watch.judge(report.last, value, report.last.impulses)) {
      report.status = *status;
      break;
    }
  }
  report.residual = iteration.residual();
  step.contacts = iteration.contacts(step.problem);
  step.velocities = iteration.velocities(step.problem);
  step.gluing = iteration.gluing();
  step.interface_impulses = iteration.interface_impulses();
  report.step = simulation.state.step + 1;
  report.contacts = count(step.contacts);
  report.overlap = interpenetration(step.problem);
  return step;
}

StepReport take_step(Simulation& simulation, SolvedStep step) {
  step.report.energy = finish_step(simulation.system, simulation.state, step.problem,
                                   simulation.dynamics.time, step.contacts, step.velocities);
  simulation.state.gluing = std::move(step.gluing);
  step.report.time = simulation.state.time;
  return step.report;
}

std::string describe_breakdown(const SolvedStep& step) {
  const auto name = [](const StepContact& c) { return fmt::format("contact of bodies {} and {}", c.a, c.b); };
  std::size_t largest = 0;
  double size = -1;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const double impulse = std::hypot(step.contacts[k].impulse_n, step.contacts[k].impulse_t);
    if (!std::isfinite(impulse)) return name(step.problem.geometry[k]) + ": impulse is no number";
    if (impulse > size) {
      size = impulse;
      largest = k;
    }
  }
  for (std::size_t i = 0; i < step.velocities.size(); ++i)
    if (!std::isfinite(step.velocities[i].x + step.velocities[i].y + step.velocities[i].rim))
      return fmt::format("disk {}: velocity is no number", i);
  if (step.contacts.empty()) return "no contact";
  return fmt::format("{}: largest impulse, {} N s", name(step.problem.geometry[largest]), size);
}

}  // namespace nscdd
