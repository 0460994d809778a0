// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/simulation/simulation.hpp>

namespace nscdd {

/// One row per iteration: `nscdd simulate --convergence`.
std::vector<Column> iteration_columns();
Row iteration_row(const IterationRow& row);

/// One row per step: the group `summary` of a trajectory.
std::vector<Column> step_columns();
Row step_row(const StepReport& report);

}  // namespace nscdd
