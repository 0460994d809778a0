// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"
#include <nscdd/core/table.hpp>

namespace nscdd {

/// Columns of the iterations of a step: `nscdd simulate --convergence`.
const ResultColumns<IterationRow>& iteration_columns();

/// Columns of the steps of a run: the group `summary` of a trajectory.
const ResultColumns<StepReport>& step_columns();

}  // namespace nscdd
