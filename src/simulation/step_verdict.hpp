// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/step_share.hpp"

namespace nscdd {

/// Decides whether a solved step has a solution, if `verdict` asks for it, and sets the verdict of its report. Without
/// a solution the status is `impossible`, unless the step broke down, and a text names the bodies of the chain:
/// "no solution: disk 0, the wall of boundary 'left': closing at 0.1 m/s". Otherwise the text is empty. All ranks call
/// it together, and each judges all contacts. A law whose contacts do not open has always a solution: no verdict.
/// `before`: the simulation that the step was solved from. `goes_on`: see IterationSink.
template <int D>
std::string judge(GranularStep<D>& step, const Simulation& before, const std::function<bool()>& goes_on = {});

}  // namespace nscdd
