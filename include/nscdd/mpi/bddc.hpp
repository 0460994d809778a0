// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/bddc.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// PCBDDC of PETSc on the unassembled M_{E,eps}, one subdomain for each rank. It shares no code with the
/// preconditioners of X_epsilon. All grains that the same two subdomains share form one edge. CHOLMOD factorises local
/// problems, MUMPS computes Schur complements. With a threshold, eigenvectors of PETSc's own problem
/// on each edge with an eigenvalue above it become constraints; they bound the condition number with deluxe weights
/// only. Throws Error for another number of ranks than of subdomains, and with PETSc's status. The first call starts
/// PETSc, unless the caller has; the last copy of the result, or of its systems, ends it and must be destroyed before
/// MPI is finalised. What PETSc sends is added to the counts of the processes.
Bddc bddc(MPI_Comm communicator);

}  // namespace nscdd::mpi
