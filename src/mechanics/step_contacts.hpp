// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/passage.hpp"

namespace nscdd {

/// Calls visit(contact) for the pairs of a free grain and a grain or wall whose gap at the end of the path is within
/// the alert distance, or would be after the step at the velocities `velocity(grain)`, V^- + h g, and those of the
/// boundaries. Pairs that met on the way and have turned since (see Passage) are visited with the normal that they met
/// with, also if they are apart again: as touching then. With `foresees` so are grains that move far in a step and meet
/// before its end, and those that miss each other are not. `least_alert`, m, replaces an alert distance of the scheme
/// that is smaller. Calls deep(overlap) for bodies that overlap too far at the end or on the way. Throws Error naming
/// both grains if two have the same centre.
template <int D>
void for_each_contact(const GranularSystem& system, const Path<D>& path,
                      const std::function<Direction<D>(Index)>& velocity, const TimeStepping& scheme,
                      double least_alert, bool foresees, const std::function<void(const StepContact&)>& visit,
                      const std::function<void(const DeepOverlap&)>& deep);

}  // namespace nscdd
