// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd-mpi: the verbs that run on several ranks.
#include "app/verbs.hpp"
#include <nscdd/mpi/bddc.hpp>
#include <nscdd/mpi/multifrontal.hpp>
#include <nscdd/mpi/processes.hpp>
#include <nscdd/mpi/slepc.hpp>

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <thread>

namespace nscdd::mpi {
namespace {

constexpr double patience = 5;  // s, until a rank that failed alone aborts the run

// The rank that reports the error of a run: the first one that failed, or the number of ranks if none did. Empty if
// this rank failed and another one has not ended within `patience`.
std::optional<Index> speaker(const app::Outcome& outcome, Index rank, Index size) {
  Index first = 0;
  const Index own = outcome.error.empty() ? size : rank;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallreduce(&own, &first, 1, MPI_INT64_T, MPI_MIN, MPI_COMM_WORLD, &request);
  const double since = app::seconds();
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return first;
    if (!outcome.error.empty() && app::seconds() - since > patience + 0.1 * static_cast<double>(rank))
      return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// The number of ranks on this computer.
Index processes_here() {
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  int size = 1;
  MPI_Comm_size(here, &size);
  MPI_Comm_free(&here);
  return size;
}

int run(int argc, char** argv) {
  const int standard_error = dup(STDERR_FILENO);
  // Destroyed after the last output: freeing the communicator is collective.
  const Processes processes = processes_of(MPI_COMM_WORLD);
  const app::Machine machine{.program = "nscdd-mpi",
                             .verbs = {"sweep", "optimum", "simulate", "inspect", "coarse"},
                             .processes = processes,
                             .processes_here = processes_here(),
                             .inertia = multifrontal(MPI_COMM_WORLD, processes.counts),
                             .slepc = slepc(MPI_COMM_WORLD),
                             .bddc = bddc(MPI_COMM_WORLD),
                             .threads = 1};
  for (std::FILE* stream : {stdout, stderr})  // the other ranks would print the same
    if (!processes.first() && std::freopen("/dev/null", "w", stream) == nullptr)
      throw Error("/dev/null: cannot be opened");
  const app::Outcome outcome = app::run_program(argc, argv, machine);
  const std::optional<Index> speaks = speaker(outcome, processes.rank, processes.size);
  if (!outcome.error.empty() && speaks.value_or(processes.rank) == processes.rank) {
    dup2(standard_error, STDERR_FILENO);
    app::note("error: {}", outcome.error);
    std::fflush(stderr);
  }
  if (!speaks) MPI_Abort(MPI_COMM_WORLD, outcome.code);
  return outcome.code;
}

}  // namespace
}  // namespace nscdd::mpi

int main(int argc, char** argv) {
  nscdd::app::open_standard_streams();
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  const int code = nscdd::mpi::run(argc, argv);
  MPI_Finalize();
  return code;
}
