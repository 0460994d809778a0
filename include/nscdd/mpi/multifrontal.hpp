// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/linalg/inertia_factor.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// Our own factorisation of matrices that the processes of a communicator share (see InertiaFactor). Each process
/// eliminates its own rows, and the border rows that no other process touches. What is left of its part is a small
/// dense front. Pairs of processes merge their fronts and eliminate the rows that no third process touches; pairs of
/// pairs go on, until nothing is left. Inertias add up. Neighbours in rank should share more than others do. The middle
/// rank merges the fronts of two sets; no rank merges twice. All processes make the same calls in the same order.
/// `work`: counts the work of this process.
InertiaMethod multifrontal(MPI_Comm communicator, std::shared_ptr<WorkCount> work = std::make_shared<WorkCount>());

}  // namespace nscdd::mpi
