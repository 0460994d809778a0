// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/step_share.hpp"

namespace nscdd {

/// A solved step of a simulation whose dimension is known when it runs.
using AnySolvedStep = std::variant<GranularStep<2>, GranularStep<3>>;

/// The residual of the contact law in a step, added up subdomain by subdomain.
template <int D>
ContactResidual residual_of(const GranularStep<D>& step, const Processes& processes) {
  std::vector<std::vector<GrainContact<D>>> of_subdomain(at(step.partition.subdomains));
  for (std::size_t k = 0; k < step.contacts.size(); ++k)
    of_subdomain[at(step.partition.subdomain_of_contact[k])].push_back(step.contacts[k]);
  std::vector<ContactResidual> residuals;
  for (const auto& own : of_subdomain) residuals.push_back(contact_residual(step.problem.law, own, step.velocities));
  return added_up(residuals, processes);
}

/// Completes a step whose contacts and velocities are found: velocities of all grains, work, overlaps, and whether the
/// step went wrong. `before`: the simulation that it was solved from.
template <int D>
void finish_solution(GranularStep<D>& step, const Simulation& before);

/// Where a solver broke down, by names and places: the first contact whose impulse is not finite, otherwise the first
/// grain with such a velocity, otherwise the contact with the largest impulse.
template <int D>
std::string describe_breakdown(const Simulation& before, const GranularStep<D>& step);

/// Advances the state by a solved step. Throws Error, and leaves the state, if bodies would pass each other before the
/// end of the step, see check_end_of_step.
template <int D>
StepReport take_step(Simulation& simulation, const GranularStep<D>& step);

}  // namespace nscdd
