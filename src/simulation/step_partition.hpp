// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/dynamics.hpp"
#include <nscdd/ddm/decomposition.hpp>

namespace nscdd {

/// The next step of a simulation before it is divided. Throws Error as prepare_step, and naming both bodies
/// if two overlap by more than `largest_overlap`.
StepProblem checked_problem(const Simulation& simulation);

/// The partition of the contacts of a step. It is made afresh every `redecompose` steps; in between, known
/// contacts stay where they are.
Partition partition_step(const Simulation& simulation, const StepProblem& problem);

/// Whether that step is partitioned afresh.
bool decomposes_afresh(const Simulation& simulation, Index step);

}  // namespace nscdd
