// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/passage.hpp"

namespace nscdd {

/// Calls visit(contact) for the pairs of a free grain and a grain or wall whose gap at the end of the path is within
/// the alert distance, or would be after the step at the velocities `velocity(grain)`, V^- + h g, and those of the
/// boundaries. Pairs that met on the path and have turned since (see Passage) are visited with the normal with which
/// they met; if they are apart again, they are visited as touching. With `foresees`, so are grains that move far in a
/// step and meet before its end, while grains that miss each other are left out. `least_alert`, m: lower bound of the
/// alert distance. Calls deep(overlap) for bodies that overlap too far at the end or on the path. Throws Error naming
/// both grains if two have the same centre.
template <int D>
void for_each_contact(const GranularSystem& system, const Path<D>& path,
                      const std::function<Direction<D>(Index)>& velocity, const TimeStepping& scheme,
                      double least_alert, bool foresees, const std::function<void(const StepContact&)>& visit,
                      const std::function<void(const DeepOverlap&)>& deep);

}  // namespace nscdd
