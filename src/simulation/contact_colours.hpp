// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include "two_stage/divided_contacts.hpp"

namespace nscdd {

/// Colours of the contacts of `problem`, the next step of a simulation or the share of it that this process has. Every
/// contact of the step takes the least colour that none before it has that shares a free grain, in the order in which
/// they are met: all processes look at all of them and find the same colours.
template <int D>
ContactColours contact_colours(const Simulation& simulation, const StepProblem<D>& problem);

}  // namespace nscdd
