// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/processes.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// The processes of a communicator, which is duplicated: messages of the caller are not disturbed. MPI must have been
/// initialised. Sums are made by one process and sent to the others: all have the same bits.
Processes processes_of(MPI_Comm communicator);

}  // namespace nscdd::mpi
