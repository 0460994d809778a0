// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/threads.hpp"
#include "mpi/petsc.hpp"
#include <nscdd/mpi/bddc.hpp>

#include <petsc/private/pcbddcimpl.h>  // PC_BDDC::coarse_size, which no function of PETSc 3.18 returns

PETSC_EXTERN PetscErrorCode MatCreate_SchurComplement(Mat);

namespace nscdd::mpi {
namespace {

static_assert(std::is_same_v<PetscInt, SparseMatrix::StorageIndex>, "PETSc with indices of 32 bits");

using OwnedKsp = Owned<KSP, KSPDestroy>;
using OwnedSet = Owned<IS, ISDestroy>;
using OwnedScatter = Owned<VecScatter, VecScatterDestroy>;
using OwnedMap = Owned<ISLocalToGlobalMapping, ISLocalToGlobalMappingDestroy>;

// PETSc's options of these parameters, under a prefix of their own, while it lives.
class Options {
 public:
  static constexpr const char* prefix = "nscdd_bddc_";

  Options(const BddcParameters& parameters, Index dofs_per_grain) {
    // Grains of the same subdomains form one class, whether they touch or not.
    set("use_local_mat_graph", "0");
    set("graph_maxcount", "2");  // grains with more than one other subdomain are vertices, and lone ones
    set("vertex_size", std::to_string(dofs_per_grain));
    set("use_edges", parameters.threshold ? "1" : "0");
    set("use_faces", "0");
    set("use_deluxe_scaling", parameters.scaling == Scaling::deluxe ? "1" : "0");
    if (parameters.threshold) set("adaptive_threshold", fmt::format("{}", *parameters.threshold));
    set("coarse_redundant_pc_type", "cholesky");  // PETSc's own: CHOLMOD refuses an empty matrix
    for (const std::string solver : {"dirichlet_", "neumann_"}) {
      set(solver + "pc_type", "cholesky");
      set(solver + "pc_factor_mat_solver_type", MATSOLVERCHOLMOD);
    }
  }
  ~Options() {
    for (const std::string& name : names_) PetscOptionsClearValue(nullptr, name.c_str());
  }
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;

 private:
  void set(const std::string& name, const std::string& value) {
    names_.push_back(fmt::format("-{}pc_bddc_{}", prefix, name));
    check(PetscOptionsSetValue(nullptr, names_.back().c_str(), value.c_str()), "an option");
  }

  std::vector<std::string> names_;
};

// Unknowns of the undivided packing: grains that have contacts, in their order.
void number_unknowns(const Decomposition& parts, const Subdomain& own, BddcSystem& system) {
  const Index d = parts.dofs_per_grain();
  Vector present = Vector::Zero(parts.interface.grains());
  present(own.grains).setOnes();
  parts.interface.processes().add_up({present.data(), at(present.size())});
  std::vector<Index> first;  // unknown of each grain
  for (const double copies : present) first.push_back(std::exchange(system.size, system.size + (copies > 0 ? d : 0)));
  for (const Index grain : own.grains)
    for (Index k = 0; k < d; ++k) system.unknowns.push_back(first[at(grain)] + k);
}

// Sets the solver up for KSPSetUp; returns its preconditioner.
PC prepare(KSP solver, Mat matrix, const BddcParameters& parameters) {
  PC preconditioner = nullptr;
  KSPSetOperators(solver, matrix, matrix);
  KSPSetType(solver, KSPCG);
  KSPSetNormType(solver, KSP_NORM_UNPRECONDITIONED);
  KSPSetTolerances(solver, parameters.tolerance, 0, PETSC_DEFAULT,
                   static_cast<PetscInt>(parameters.maximum_iterations));
  KSPSetComputeSingularValues(solver, PETSC_TRUE);
  KSPSetOptionsPrefix(solver, Options::prefix);
  KSPGetPC(solver, &preconditioner);
  check(PCSetType(preconditioner, PCBDDC), "BDDC");
  PCISSetUseStiffnessScaling(preconditioner, parameters.scaling == Scaling::stiffness ? PETSC_TRUE : PETSC_FALSE);
  check(KSPSetFromOptions(solver), "options of BDDC");
  return preconditioner;
}

// What a system holds until its last solution.
struct Solver {
  std::shared_ptr<void> session;
  std::shared_ptr<const Communicator> all;
  std::shared_ptr<WorkCount> counts;
  SparseMatrix own;  // M_{E,eps}
  OwnedMap map;
  OwnedMatrix local, matrix;
  OwnedVector b, x, share;  // right-hand side and solution, and this rank's copies of either
  OwnedScatter copies;
  OwnedKsp ksp;
};

// Adds what PETSc sends while it lives to the counts of a rank.
class CountedMessages {
 public:
  explicit CountedMessages(WorkCount& counts) : counts_(counts), before_(now()) {}
  ~CountedMessages() {
    const WorkCount after = now();
    counts_.messages += after.messages - before_.messages;
    counts_.message_bytes += after.message_bytes - before_.message_bytes;
    counts_.sums += after.sums - before_.sums;
  }
  CountedMessages(const CountedMessages&) = delete;
  CountedMessages& operator=(const CountedMessages&) = delete;

 private:
  static WorkCount now() {
    return {.messages = petsc_isend_ct + petsc_send_ct,
            .message_bytes = petsc_isend_len + petsc_send_len,
            .sums = petsc_allreduce_ct + petsc_gather_ct + petsc_scatter_ct};
  }

  WorkCount& counts_;
  WorkCount before_;
};

double flops_so_far() {
  PetscLogDouble flops = 0;
  PetscGetFlops(&flops);
  return flops;
}

void fill(Solver& solver, const BddcSystem& system) {
  std::vector<PetscInt> rows(system.unknowns.begin(), system.unknowns.end());
  const auto n = static_cast<PetscInt>(rows.size()), size = static_cast<PetscInt>(system.size);
  const MPI_Comm all = solver.all->get();
  OwnedSet of_rank;
  SparseMatrix& k = solver.own;
  check(ISLocalToGlobalMappingCreate(all, 1, n, rows.data(), PETSC_COPY_VALUES, solver.map.fill()), "a map");
  check(MatCreateIS(all, 1, PETSC_DECIDE, PETSC_DECIDE, size, size, solver.map.get(), solver.map.get(),
                    solver.matrix.fill()),
        "a matrix of subdomains");
  check(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, k.outerIndexPtr(), k.innerIndexPtr(), k.valuePtr(),
                                  solver.local.fill()),
        "the matrix of a subdomain");
  for (const Mat one : {solver.local.get(), solver.matrix.get()}) MatSetOption(one, MAT_SPD, PETSC_TRUE);
  check(MatISSetLocalMat(solver.matrix.get(), solver.local.get()), "the matrix of a subdomain");
  MatAssemblyBegin(solver.matrix.get(), MAT_FINAL_ASSEMBLY);
  check(MatAssemblyEnd(solver.matrix.get(), MAT_FINAL_ASSEMBLY), "a matrix of subdomains");
  check(MatCreateVecs(solver.matrix.get(), solver.x.fill(), solver.b.fill()), "vectors");
  check(VecCreateSeq(PETSC_COMM_SELF, n, solver.share.fill()), "a vector");
  check(ISCreateGeneral(PETSC_COMM_SELF, n, rows.data(), PETSC_COPY_VALUES, of_rank.fill()), "rows");
  check(VecScatterCreate(solver.b.get(), of_rank.get(), solver.share.get(), nullptr, solver.copies.fill()),
        "an exchange");
}

// Calls work(entries) on the vector of a rank's copies.
void with_entries(const Solver& solver, const auto& work) {
  double* values = nullptr;
  check(VecGetArray(solver.share.get(), &values), "entries of a vector");
  work(Eigen::Map<Vector>(values, solver.own.rows()));
  VecRestoreArray(solver.share.get(), &values);
}

void exchange(const Solver& solver, Vec from, Vec to, InsertMode mode, ScatterMode direction) {
  VecScatterBegin(solver.copies.get(), from, to, mode, direction);
  check(VecScatterEnd(solver.copies.get(), from, to, mode, direction), "an exchange");
}

BddcSolution solution(const Solver& solver, const Vector& right) {
  const OneBlasThread serial_blas;
  const QuietPetsc quiet;
  const CountedMessages counted(*solver.counts);
  BddcSolution result;
  const double begun = MPI_Wtime(), flops = flops_so_far();
  with_entries(solver, [&](auto entries) { entries = right; });
  VecSet(solver.b.get(), 0);
  exchange(solver, solver.share.get(), solver.b.get(), ADD_VALUES, SCATTER_REVERSE);
  check(KSPSolve(solver.ksp.get(), solver.b.get(), solver.x.get()), "a solution");
  exchange(solver, solver.x.get(), solver.share.get(), INSERT_VALUES, SCATTER_FORWARD);
  with_entries(solver, [&](auto entries) { result.velocities = entries; });
  result.seconds = MPI_Wtime() - begun;
  result.flops = flops_so_far() - flops;

  PetscInt iterations = 0;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  KSPGetIterationNumber(solver.ksp.get(), &iterations);
  KSPGetConvergedReason(solver.ksp.get(), &reason);
  check(KSPComputeExtremeSingularValues(solver.ksp.get(), &result.lambda_max, &result.lambda_min),
        "a condition number");
  result.iterations = iterations;
  result.converged = reason > 0;
  return result;
}

}  // namespace

Bddc bddc(MPI_Comm communicator) {
  const auto all = std::make_shared<const Communicator>(communicator);
  const auto session = std::make_shared<std::shared_ptr<void>>();  // begins at the first call
  return [session, all](const Decomposition& parts, SparseMatrix matrix, const BddcParameters& parameters) {
    const Subdomain& own = parts.subdomains[at(own_subdomain(parts))];
    if (parts.interface.processes().any(own.grains.empty()))
      fail("bddc: expected contacts in every subdomain, met a subdomain without");
    if (!*session) *session = slepc_session();
    const OneBlasThread serial_blas;
    const QuietPetsc quiet;
    MatRegister(MATSCHURCOMPLEMENT, MatCreate_SchurComplement);  // a second session of PETSc 3.18 forgets this type
    const auto solver = std::make_shared<Solver>();
    solver->session = *session;
    solver->all = all;
    solver->counts = parts.interface.processes().counts;
    solver->own = std::move(matrix);
    solver->own.makeCompressed();
    const CountedMessages counted(*solver->counts);
    BddcSystem system;
    number_unknowns(parts, own, system);
    const Options options(parameters, parts.dofs_per_grain());
    fill(*solver, system);
    check(KSPCreate(all->get(), solver->ksp.fill()), "a solver");
    const PC preconditioner = prepare(solver->ksp.get(), solver->matrix.get(), parameters);
    const double begun = MPI_Wtime(), flops = flops_so_far();
    check(KSPSetUp(solver->ksp.get()), "a preconditioner");
    system.setup_seconds = MPI_Wtime() - begun;
    system.setup_flops = flops_so_far() - flops;
    system.coarse_size = static_cast<const PC_BDDC*>(preconditioner->data)->coarse_size;
    system.solve = [solver](const Vector& right) { return solution(*solver, right); };
    return system;
  };
}

}  // namespace nscdd::mpi
