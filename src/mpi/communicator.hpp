// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mpi.h>

namespace nscdd::mpi {

/// A duplicate of a communicator, freed with the object unless MPI is finalised already.
class Communicator {
 public:
  explicit Communicator(MPI_Comm of) { MPI_Comm_dup(of, &own_); }
  ~Communicator() {
    int finalised = 0;
    MPI_Finalized(&finalised);
    if (finalised == 0) MPI_Comm_free(&own_);
  }
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  MPI_Comm get() const { return own_; }
  int rank() const {
    int rank = 0;
    MPI_Comm_rank(own_, &rank);
    return rank;
  }
  int size() const {
    int size = 1;
    MPI_Comm_size(own_, &size);
    return size;
  }

 private:
  MPI_Comm own_ = MPI_COMM_NULL;
};

}  // namespace nscdd::mpi
