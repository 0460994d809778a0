// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/moving/interface_iterations.hpp"

#include "linalg/pencil.hpp"
#include "two_stage/cut_contacts.hpp"
#include "two_stage/granular_two_stage.hpp"

namespace nscdd {
namespace {

constexpr Index most_eigenvalues = 2500;
constexpr Index most_iterations = 3000;

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
  // A law that pulls is Coulomb's for impulses that are larger by the pull, which then act from the beginning.
  std::vector<GrainVelocity<D>> free = step.problem.free;
  for (const GrainContact<D>& contact : step.contacts) apply_impulse(contact, LocalVector<D>{-contact.pull, {}}, free);
  for (Index c = 0; c < count(step.contacts); ++c) {
    const GrainContact<D>& contact = step.contacts[at(c)];
    const double rho = 1 / (1 / contact.inverse_w.inverse_n + alpha);
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
FrozenInterface frozen_interface(const Decomposition& parts, const FrozenSystem<D>& system, InterfaceNetwork network,
                                 double flexibility) {
  CutContacts<D> cut(parts, {network, flexibility, frozen_tolerance, most_iterations, multifrontal()});
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

// The two-stage Newton method on the step, and one linear system at its end with each network.
template <int D>
InterfaceIterations by_newton(const Simulation& simulation) {
  const double flexibility = simulation.dynamics.solver.interface_flexibility;
  const GranularStep<D> step = solve_step<D>(simulation);
  InterfaceIterations result;
  result.report = step.report;
  result.subdomains = step.partition.subdomains;
  result.systems = step.report.interface_systems;
  for (const GrainContact<D>& contact : step.contacts) {
    const ContactStatus status = status_of(step.problem.law, contact);
    result.stick += status == ContactStatus::stick;
    result.slide += status != ContactStatus::stick && status != ContactStatus::open;
  }
  const Decomposition parts =
      decompose(reference_problem(step.problem, simulation.system.grains()), partition_of_columns(step.partition, D));
  const FrozenSystem<D> system = frozen_system(step);
  result.none = frozen_interface(parts, system, InterfaceNetwork::none, flexibility);
  result.all = frozen_interface(parts, system, InterfaceNetwork::all, flexibility);
  result.active = frozen_interface(parts, system, InterfaceNetwork::active, flexibility);
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
  solver.maximum_iterations = std::max<Index>(solver.maximum_iterations / 100, 1);  // 100 of these in each
  const StepReport report = solved_report(simulation);
  return {report.last.sweeps, report.status == SolverStatus::converged};
}

}  // namespace

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

}  // namespace nscdd
