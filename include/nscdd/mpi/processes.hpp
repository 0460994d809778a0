// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/processes.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// The ranks of a communicator, which is duplicated, so that messages of the caller do not interfere. MPI must be
/// initialised. Rank 0 forms sums and sends them to the others, so that all have the same bits.
Processes processes_of(MPI_Comm communicator);

}  // namespace nscdd::mpi
