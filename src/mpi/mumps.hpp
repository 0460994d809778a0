// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/linalg/inertia_factor.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// The L D L^T of MUMPS on matrices that the processes of a communicator share (see InertiaFactor): each hands over its
/// part and keeps its share of the factor. The inertia is exact: the last front is factorised like all others
/// (ICNTL(13) = 1), and no pivot is replaced. All processes make the same calls in the same order, destruction of the
/// factors included.
InertiaMethod mumps(MPI_Comm communicator);

}  // namespace nscdd::mpi
