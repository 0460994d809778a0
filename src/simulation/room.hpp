// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/solved_step.hpp"

namespace nscdd {

/// Energies of a step, J, that say whether it went wrong. They are those of all processes.
struct StepRoom {
  double motion = 0;      ///< of all free grains: before, in free flight, and at the speed of the fastest body or push
  double in_the_end = 0;  ///< of all free grains
  double lifting = 0;     ///< to lift all free grains as far as the fastest body or push moves
  double pushes = 0;      ///< what pushes of overlaps may do
  double boundaries = 0;  ///< what boundaries do
  double closing = 0;     ///< sum of r_n max(0, -u_n), with u_n that of the law: 0 in a solution
};

/// `pushes`, `closing`: of all contacts.
template <int D>
StepRoom room_of(const Simulation& before, const SolvedStep<D>& step, double pushes, double closing);

/// Contacts dissipate. Energy comes only from driven bodies, which pass on at most twice their speed, and from pushes:
/// a contact whose bodies overlap does the work r_n times the speed at which it pushes them apart. (Speeds of pushes
/// add up along a chain of overlaps, but so do the impulses.) A step that ends with many times the energy of all these
/// diverged, even after few iterations.
bool energy_exploded(const StepRoom& room);

/// Whether boundaries or pushes seem to leave no room. If no impulses keep all contacts from closing, solvers raise
/// impulses that balance each other. Three signs together: these impulses are much larger than what drives the step,
/// their work is much larger than all energies of motion, and a good part of it is done against contacts that still
/// close. If boundaries and pushes are at rest, every step has a solution. `residual`: of the step.
bool no_room(const StepRoom& room, const ContactResidual& residual);

}  // namespace nscdd
