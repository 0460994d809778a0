// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/spectra/spectral_radius.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// Both ends of the spectrum of S f = lambda P f by Krylov-Schur of SLEPc, on the pencil K - tau N of the velocities V
/// of S, those of P, V', and the interface impulses,
///     K = [ M + K/epsilon   0   A^T ]      N = [ 0                  ]
///         [ 0               0   A^T ]          [    M' + K'/eta     ]
///         [ A               A   0   ]          [                 0  ]
/// whose eigenvalues are tau = 1 / lambda, and 0, often. With n rows of V' it has n + #{lambda > 1/tau} negative
/// eigenvalues, by which a shift next to each end is found; PETSc holds the matrices, and MUMPS factorises them.
///
/// It shares no code with the search of `shift_invert` and proves nothing: the residual is the larger one of SLEPc's
/// and of the difference between an eigenvalue and the Rayleigh quotient of its vector with S and P themselves.
/// Further eigenvalues are not asked for: a Krylov space of one vector may miss copies. The lists are empty where SLEPc
/// breaks down, as it does where S is next to P. Throws Error in the rigid limit. All processes of the communicator
/// take part. PETSc begins where it is first asked for, unless the caller has begun it, and ends with the last copy of
/// the result, which should go before MPI is finalised.
SpectrumSolver slepc(MPI_Comm communicator);

}  // namespace nscdd::mpi
