// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/step_decomposition.hpp"

#include <nscdd/spectra/optimal_eta.hpp>

namespace nscdd {
namespace {

// Columns that statuses leave in the linear problem: all of contacts that stick, the normal one of those that slide.
std::vector<char> columns_left_by(const std::vector<ContactStatus>& statuses, std::size_t dimension) {
  std::vector<char> kept;
  for (const ContactStatus status : statuses) {
    kept.push_back(status != ContactStatus::open);
    kept.insert(kept.end(), dimension - 1, status == ContactStatus::stick);
  }
  return kept;
}

// The decomposition without tangential columns of contacts without friction: they make Stage 2 too stiff to converge.
template <int D>
Decomposition linear_parts(const Simulation& simulation, const GranularStep<D>& step) {
  const StepProblem<D>& problem = step.problem;
  Decomposition all = linear_decomposition(simulation, step);
  const bool always = !opens(problem.law);
  std::vector<char> usable(D * problem.contacts.size(), 1);
  for (std::size_t k = 0; k < problem.contacts.size(); ++k)
    std::fill_n(usable.begin() + static_cast<Index>(D * k + 1), D - 1, always || problem.contacts[k].friction > 0);
  return std::ranges::count(usable, 0) == 0 ? all : restrict_contacts(all, usable);
}

// Columns of the contacts that carried an impulse in the last step; all columns in the first step.
template <int D>
std::vector<char> active_columns(const Simulation& simulation, const GranularStep<D>& step) {
  const StepProblem<D>& problem = step.problem;
  const auto& impulses = step.process_of_subdomain.empty() ? simulation.state.impulses : step.impulses;
  if (!simulation.processes.any(!impulses.empty())) return std::vector<char>(D * problem.contacts.size(), 1);
  const auto last = remembered(impulses, problem.geometry);
  std::vector<ContactStatus> statuses(last.size(), ContactStatus::open);
  for (std::size_t k = 0; k < last.size(); ++k) {
    if (last[k] == nullptr) continue;
    GrainContact<D> contact = problem.contacts[k];
    contact.impulse = recalled<D>(last[k]->impulse, contact.normal);
    statuses[k] = status_of(problem.law, contact);
  }
  return columns_left_by(statuses, D);
}

// The network after 100 undecomposed sweeps of this step: near enough to that at its end to choose a flexibility, and
// known in the first step, too. Every rank sweeps all contacts.
template <int D>
std::vector<char> expected_columns(const Simulation& simulation, const StepProblem<D>& problem) {
  StepProblem<D> step = whole_step<D>(simulation);
  set_scale(step, simulation.dynamics.interaction, problem.scale);
  const Partition whole{.subdomain_of_contact = std::vector<Index>(step.contacts.size(), 0)};
  GranularTwoStage<D> iteration(decompose(step, whole, ContactOrder::natural, 0), step.law,
                                {.gauss_seidel_sweeps = 100}, {});
  iteration.start({});
  iteration.iterate();
  const std::vector<ContactStatus> found = iteration.statuses();
  std::vector<ContactStatus> own;  // both lists of contacts ascend
  for (std::size_t k = 0; k < step.geometry.size() && own.size() < problem.geometry.size(); ++k)
    if (const StepContact& c = step.geometry[k], &next = problem.geometry[own.size()]; c.a == next.a && c.b == next.b)
      own.push_back(found[k]);
  return columns_left_by(own, D);
}

}  // namespace

void add_places(Decomposition& parts, const Simulation& simulation) {
  const GranularSystem& system = simulation.system;
  const Configuration where = where_contacts_are(start_of(simulation));
  const Index d = system.dimension, spins = d * (d - 1) / 2;
  const Eigen::Matrix3d unit_spins{{0, 0, 1}, {0, -1, 0}, {1, 0, 0}};
  for (Subdomain& subdomain : parts.subdomains) {
    const Index n = count(subdomain.grains);
    subdomain.centres.resize(d, n);
    subdomain.turning.resize(spins * n, spins);
    for (Index i = 0; i < n; ++i) {
      const Index number = subdomain.grains[at(i)];
      const bool grain = number < system.grains();
      const Pose pose = grain ? Pose{} : where.poses[at(system.free_bodies[at(number - system.grains())])];
      const Place centre = grain ? where.centre(at(number)) : pose.place();
      Eigen::Matrix3d rims = Eigen::Vector3d::Map(system.rims(number).data()).asDiagonal();
      if (!grain) rims *= principal_axes(*system.body(number).body, pose).transpose();
      subdomain.centres.col(i) = Eigen::Vector3d::Map(centre.data()).head(d);
      subdomain.turning.middleRows(spins * i, spins) = (rims * unit_spins).bottomLeftCorner(spins, spins);
    }
  }
}

template <int D>
InterfaceOperator enriched_operator(const Simulation& simulation, const GranularStep<D>& step, double eta) {
  const Decomposition all = linear_parts(simulation, step);
  const StepSolver& solver = simulation.dynamics.solver;
  const bool active = solver.network == StageTwoNetwork::active || solver.enrichment == Enrichment::semi_implicit;
  return InterfaceFamily(active ? restrict_contacts(all, active_columns(simulation, step)) : all,
                         InterfaceFamily::default_dense_limit, simulation.inertia)
      .at(eta);
}

template <int D>
double best_eta(const Simulation& simulation, const GranularStep<D>& step) {
  const Decomposition all = linear_parts(simulation, step);
  const StepSolver& solver = simulation.dynamics.solver;
  const SpectralOptions options{.inertia = simulation.inertia};
  // Conjugate gradients choose their own steps.
  const bool relaxed = solver.interface_method == InterfaceMethod::richardson;
  const double stable = stable_eta(all, relaxed ? solver.interface_relaxation : 1.0, options);
  if (!decomposes_afresh(simulation, simulation.state.step) && simulation.state.eta > 0)
    return std::max(simulation.state.eta, stable);  // contacts may be new since then
  return std::max(optimal_eta(all, restrict_contacts(all, expected_columns(simulation, step.problem)), options),
                  stable);
}

template InterfaceOperator enriched_operator(const Simulation&, const GranularStep<2>&, double);
template InterfaceOperator enriched_operator(const Simulation&, const GranularStep<3>&, double);
template double best_eta(const Simulation&, const GranularStep<2>&);
template double best_eta(const Simulation&, const GranularStep<3>&);

}  // namespace nscdd
