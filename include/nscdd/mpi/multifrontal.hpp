// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/linalg/inertia_factor.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// Our own factorisation of matrices that the processes of a communicator share (see InertiaFactor). Each eliminates
/// its rows, and the border rows that are its alone; what is left of its part is dense, and small. Pairs of processes
/// put these together and eliminate what no third one has, pairs of pairs go on, until nothing is left. Inertias add.
/// Processes next to each other in rank should share more than others do, and the one in the middle between two sets
/// puts theirs together, so that each does so once at most. All make the same calls in the same order. `work`: where
/// this process counts what it does.
InertiaMethod multifrontal(MPI_Comm communicator, std::shared_ptr<WorkCount> work = std::make_shared<WorkCount>());

}  // namespace nscdd::mpi
