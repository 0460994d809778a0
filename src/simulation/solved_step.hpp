// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/step_share.hpp"

#include <variant>

namespace nscdd {

/// A solved step of a simulation whose dimension is known when it runs.
using AnySolvedStep = std::variant<GranularStep<2>, GranularStep<3>>;

/// How well the contacts of a step obey their law at the velocities of the bodies, added up subdomain by subdomain.
template <int D>
ContactResidual residual_of(const GranularStep<D>& step, const Processes& processes);

/// Completes a step whose contacts and velocities are found: the velocities of all grains, those that touch nothing
/// included, work, overlaps, and whether the step went wrong. `before`: what it was solved from.
template <int D>
void finish_solution(GranularStep<D>& step, const Simulation& before);

/// Where a solver broke down, by names and places: the first contact whose impulse is not finite, otherwise the first
/// disk with such a velocity, otherwise the contact with the largest impulse. `before`: what the step was solved from.
template <int D>
std::string describe_breakdown(const Simulation& before, const GranularStep<D>& step);

/// Takes a solved step, which moves the state on. Throws Error, and takes nothing, if bodies would pass each other
/// between the contacts and the end of the step, see check_end_of_step.
template <int D>
StepReport take_step(Simulation& simulation, const GranularStep<D>& step);

}  // namespace nscdd
