// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/step_share.hpp"

namespace nscdd {

/// A solved step of a simulation whose dimension is known when it runs.
using AnySolvedStep = std::variant<GranularStep<2>, GranularStep<3>>;

/// The residual of the contact law in a step, added up subdomain by subdomain, with the scale that its report has.
template <int D>
ContactResidual residual_of(const GranularStep<D>& step, const Processes& processes) {
  std::vector<std::vector<GrainContact<D>>> of_subdomain(at(step.partition.subdomains));
  for (std::size_t k = 0; k < step.contacts.size(); ++k)
    of_subdomain[at(step.partition.subdomain_of_contact[k])].push_back(step.contacts[k]);
  std::vector<ContactResidual> residuals;
  for (const auto& own : of_subdomain) residuals.push_back(contact_residual(step.problem.law, own, step.velocities));
  ContactResidual sum = added_up(residuals, processes);
  sum.scale = step.report.residual.scale;
  return sum;
}

/// Completes a step whose contacts and velocities are found: velocities of all grains, work, overlaps, and whether the
/// step went wrong. `before`: the simulation that it was solved from.
template <int D>
void finish_solution(GranularStep<D>& step, const Simulation& before);

/// Where a solver broke down, by names and places: the first contact whose impulse is not finite, otherwise the first
/// grain with such a velocity, otherwise the contact with the largest impulse.
template <int D>
std::string describe_breakdown(const Simulation& before, const GranularStep<D>& step);

/// Decides whether a solved step has a solution, if `verdict` asks for it, and sets the verdict of its report. Without
/// a solution the status is `impossible`, unless the step broke down, and a text names the bodies of the chain:
/// "no solution: disk 0, the wall of boundary 'left': closing at 0.1 m/s". Otherwise the text is empty. All ranks call
/// it together, and each judges all contacts. A law whose contacts do not open has always a solution: no verdict.
/// `before`: the simulation that the step was solved from. `goes_on`: see IterationSink.
template <int D>
std::string judge(GranularStep<D>& step, const Simulation& before, const std::function<bool()>& goes_on = {});

/// Advances the state by a solved step. Throws Error, and leaves the state, if bodies would pass each other before the
/// end of the step, see check_end_of_step.
template <int D>
StepReport take_step(Simulation& simulation, const GranularStep<D>& step);

}  // namespace nscdd
