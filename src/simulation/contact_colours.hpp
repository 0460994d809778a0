// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include "two_stage/divided_contacts.hpp"

namespace nscdd {

/// Colours of the contacts of `problem`, the next step of a simulation or the share of this process. Greedy: in the
/// order in which contacts are found, each takes the least colour that no earlier contact on its free grains has. Every
/// process colours all contacts of the step, and finds the same colours.
template <int D>
ContactColours contact_colours(const Simulation& simulation, const StepProblem<D>& problem);

}  // namespace nscdd
