// SPDX-License-Identifier: GPL-3.0-or-later
// Several processes share the radius of a lattice, against the installed component mpi. The program around it has a
// communicator of its own for them, next to a process that takes no part, and a message of its own under way on it.
#include <nscdd/mpi/multifrontal.hpp>
#include <nscdd/mpi/processes.hpp>
#include <nscdd/mpi/slepc.hpp>
#include <nscdd/nscdd.hpp>

#include <cmath>
#include <iostream>

namespace {

using namespace nscdd;

bool agree(const SpectralRadius& a, const SpectralRadius& b) {
  return a.converged && b.converged && std::abs(a.value - b.value) <= a.residual + b.residual + 1e-10;
}

// Whether the processes of a communicator find the radii that one process finds.
bool radii_are_shared(MPI_Comm communicator) {
  const Packing packing = with_masses(generate(Generator(HexagonalLattice{.columns = 30, .rows = 30, .radius = 0.5})),
                                      {MassModel::unit, 0});
  const ContactNetwork network = detect_contacts(packing);
  const auto whole = decompose(assemble(packing, network), partition(GridPartitioner{{3, 3}}, packing, network));
  const Processes processes = mpi::processes_of(communicator);
  const auto own = of_process(whole, deal_out(whole, processes.size), processes);
  SpectralOptions options{.solver = SpectralSolver::shift_invert, .certify = true};
  const Enriched scheme{.eta = 0.5};
  const LinearViscous law{.epsilon = 0.1};
  const SpectralRadius expected = spectral_radius(contraction(whole, scheme, law), options);
  options.inertia = mpi::multifrontal(communicator);
  const SpectralRadius found = spectral_radius(contraction(own, scheme, law), options);
  const SpectralRadius witness = spectral_radius(contraction(own, scheme, law),
                                                 {.solver = SpectralSolver::slepc, .slepc = mpi::slepc(communicator)});
  if (processes.first()) std::cout << processes.size << " processes: rho = " << found.value << '\n';
  return found.certified && agree(found, expected) && agree(witness, expected);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  MPI_Comm mine = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, rank == 0 ? MPI_UNDEFINED : 0, rank, &mine);
  int well = 1;
  if (mine != MPI_COMM_NULL) {
    int place = 0, many = 1;
    MPI_Comm_rank(mine, &place);
    MPI_Comm_size(mine, &many);
    const int before = (place + many - 1) % many, after = (place + 1) % many;
    double sent = place, received = -1;
    MPI_Request requests[2];
    MPI_Isend(&sent, 1, MPI_DOUBLE, after, 0, mine, &requests[0]);
    well = radii_are_shared(mine) ? 1 : 0;
    MPI_Irecv(&received, 1, MPI_DOUBLE, before, 0, mine, &requests[1]);
    MPI_Waitall(2, requests, MPI_STATUSES_IGNORE);
    if (received != before) well = 0;
    MPI_Comm_free(&mine);
  }
  int all_well = 0;
  MPI_Allreduce(&well, &all_well, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  MPI_Finalize();
  return all_well == 1 ? 0 : 1;
}
