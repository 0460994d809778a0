// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/spectra/spectral_radius.hpp>

#include <mpi.h>

namespace nscdd::mpi {

/// Both ends of the spectrum of S f = lambda P f by Krylov-Schur of SLEPc, on the pencil K - tau N in the velocities V
/// of S, V' of P, and the interface impulses,
///     K = [ M + K/epsilon   0   A^T ]      N = [ 0                  ]
///         [ 0               0   A^T ]          [    M' + K'/eta     ]
///         [ A               A   0   ]          [                 0  ]
/// whose eigenvalues are tau = 1 / lambda, and 0 with a high multiplicity. With n rows of V', K - tau N has
/// n + #{lambda > 1/tau} negative eigenvalues, which gives a shift next to each end. MUMPS factorises.
///
/// It shares no code with the search of `shift_invert` and has no certificate: the residual is the larger of SLEPc's
/// and of the difference between an eigenvalue and the Rayleigh quotient of its vector with S and P themselves. Only
/// the ends are computed: a Krylov space of one vector may miss copies. The lists are empty if SLEPc breaks down, as it
/// does if S is nearly P. Throws Error in the rigid limit. Collective. The first call starts PETSc, unless the caller
/// has; the last copy of the result ends it and must be destroyed before MPI is finalised.
SpectrumSolver slepc(MPI_Comm communicator);

}  // namespace nscdd::mpi
