// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mpi/processes.hpp>

/// The ranks of this program.
inline const nscdd::Processes& world() {
  static const nscdd::Processes processes = nscdd::mpi::processes_of(MPI_COMM_WORLD);
  return processes;
}
