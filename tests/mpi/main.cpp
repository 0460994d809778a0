// SPDX-License-Identifier: GPL-3.0-or-later
// Every process runs every test; whatever fails in one of them fails the run.
#define DOCTEST_CONFIG_IMPLEMENT
#include "../support/blas_kernels.hpp"

#include <doctest/doctest.h>
#include <mpi.h>

int main(int argc, char** argv) {
  nscdd::testing::use_kernels_of_this_processor(argv);
  MPI_Init(&argc, &argv);
  doctest::Context context(argc, argv);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank > 0) context.setOption("minimal", true);  // says what fails, and nothing else
  const int result = context.run();
  MPI_Finalize();
  return result;
}
