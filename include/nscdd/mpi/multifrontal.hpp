// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/linalg/inertia_factor.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// Distributed multifrontal factorisation (see InertiaFactor). Each rank eliminates its own rows and the border rows
/// that no other rank touches; a small dense front is left. Pairs of ranks merge their fronts and eliminate the rows
/// that no third rank touches, then pairs of pairs, until nothing is left. Inertias add up. The middle rank merges the
/// fronts of two sets; no rank merges twice. Ranks that share many rows should have neighbouring numbers. All calls are
/// collective. `work` counts the work of this rank.
InertiaMethod multifrontal(MPI_Comm communicator, std::shared_ptr<WorkCount> work = std::make_shared<WorkCount>());

}  // namespace nscdd::mpi
