// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/random.hpp"
#include "linalg/threads.hpp"
#include "mpi/petsc.hpp"
#include <nscdd/mpi/bddc.hpp>

#include <petsc/private/pcbddcimpl.h>  // PC_BDDC::coarse_size, which no function of PETSc 3.18 returns

PETSC_EXTERN PetscErrorCode MatCreate_SchurComplement(Mat);

namespace nscdd::mpi {
namespace {

constexpr double tolerance = 1e-8;
constexpr int most_iterations = 5000;
static_assert(std::is_same_v<PetscInt, SparseMatrix::StorageIndex>, "PETSc with indices of 32 bits");

using OwnedKsp = Owned<KSP, KSPDestroy>;
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
struct Numbering {
  Numbering(const Decomposition& parts, const Subdomain& own) {
    const Index d = parts.dofs_per_grain();
    Vector present = Vector::Zero(parts.interface.grains());
    present(own.grains).setOnes();
    parts.interface.processes().add_up({present.data(), at(present.size())});
    std::vector<Index> first;  // unknown of each grain
    for (const double copies : present) first.push_back(std::exchange(size, size + (copies > 0 ? d : 0)));
    for (const Index grain : own.grains)
      for (Index k = 0; k < d; ++k) rows.push_back(static_cast<PetscInt>(first[at(grain)] + k));
  }

  Index size = 0;
  std::vector<PetscInt> rows;  // of this rank's subdomain
};

// The subdomain of this rank.
const Subdomain& own_subdomain(const Decomposition& parts) {
  const Interface& glued = parts.interface;
  if (glued.processes().size != count(parts.subdomains))
    fail("bddc: expected as many processes as subdomains, {}, met {}", count(parts.subdomains), glued.processes().size);
  Index own = 0;
  while (glued.process_of(own) != glued.processes().rank) ++own;
  return parts.subdomains[at(own)];
}

// The share of a whole vector that PETSc puts on this rank.
template <class Share>
void with_share(Vec of_petsc, Vector& whole, const Share& share) {
  PetscInt first = 0, last = 0;
  double* values = nullptr;
  VecGetOwnershipRange(of_petsc, &first, &last);
  check(VecGetArray(of_petsc, &values), "entries of a vector");
  share(whole.segment(first, last - first), Eigen::Map<Vector>(values, last - first));
  VecRestoreArray(of_petsc, &values);
}

void prepare(KSP solver, Mat matrix, const BddcParameters& parameters) {
  PC preconditioner = nullptr;
  KSPSetOperators(solver, matrix, matrix);
  KSPSetType(solver, KSPCG);
  KSPSetNormType(solver, KSP_NORM_UNPRECONDITIONED);
  KSPSetTolerances(solver, tolerance, 0, PETSC_DEFAULT, most_iterations);
  KSPSetComputeSingularValues(solver, PETSC_TRUE);
  KSPSetOptionsPrefix(solver, Options::prefix);
  KSPGetPC(solver, &preconditioner);
  check(PCSetType(preconditioner, PCBDDC), "BDDC");
  PCISSetUseStiffnessScaling(preconditioner, parameters.scaling == Scaling::stiffness ? PETSC_TRUE : PETSC_FALSE);
  check(KSPSetFromOptions(solver), "options of BDDC");
}

BddcSolution solve(const Decomposition& parts, const BddcParameters& parameters, const Communicator& all) {
  const Subdomain& own = own_subdomain(parts);
  const OneBlasThread serial_blas;
  const QuietPetsc quiet;
  MatRegister(MATSCHURCOMPLEMENT, MatCreate_SchurComplement);  // a second session of PETSc 3.18 forgets this type
  const Numbering numbering(parts, own);
  const Options options(parameters, parts.dofs_per_grain());
  SparseMatrix m = own.h * SparseMatrix(own.h.transpose()) / parameters.flexibility;  // outlives `local`
  m += SparseMatrix(own.inertia.asDiagonal());
  m.makeCompressed();
  const auto n = static_cast<PetscInt>(m.rows()), size = static_cast<PetscInt>(numbering.size);
  OwnedMap map;
  OwnedMatrix local, matrix;
  OwnedVector b, x;
  OwnedKsp solver;
  check(ISLocalToGlobalMappingCreate(all.get(), 1, n, numbering.rows.data(), PETSC_COPY_VALUES, map.fill()), "a map");
  check(MatCreateIS(all.get(), 1, PETSC_DECIDE, PETSC_DECIDE, size, size, map.get(), map.get(), matrix.fill()),
        "a matrix of subdomains");
  check(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, m.outerIndexPtr(), m.innerIndexPtr(), m.valuePtr(),
                                  local.fill()),
        "the matrix of a subdomain");
  for (const Mat one : {local.get(), matrix.get()}) MatSetOption(one, MAT_SPD, PETSC_TRUE);
  check(MatISSetLocalMat(matrix.get(), local.get()), "the matrix of a subdomain");
  MatAssemblyBegin(matrix.get(), MAT_FINAL_ASSEMBLY);
  check(MatAssemblyEnd(matrix.get(), MAT_FINAL_ASSEMBLY), "a matrix of subdomains");
  check(MatCreateVecs(matrix.get(), x.fill(), b.fill()), "vectors");

  BddcSolution result;
  result.right_hand_side = RandomStream(1).normal_vector(numbering.size);
  with_share(b.get(), result.right_hand_side, [](const auto& whole, auto entries) { entries = whole; });
  check(KSPCreate(all.get(), solver.fill()), "a solver");
  prepare(solver.get(), matrix.get(), parameters);
  const double begun = MPI_Wtime();
  check(KSPSetUp(solver.get()), "a preconditioner");
  const double ready = MPI_Wtime();
  check(KSPSolve(solver.get(), b.get(), x.get()), "a solution");
  result.setup_seconds = ready - begun;
  result.seconds = MPI_Wtime() - ready;

  PetscInt iterations = 0;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PC preconditioner = nullptr;
  KSPGetIterationNumber(solver.get(), &iterations);
  KSPGetConvergedReason(solver.get(), &reason);
  KSPGetPC(solver.get(), &preconditioner);
  check(KSPComputeExtremeSingularValues(solver.get(), &result.lambda_max, &result.lambda_min), "a condition number");
  result.iterations = iterations;
  result.coarse_size = static_cast<const PC_BDDC*>(preconditioner->data)->coarse_size;
  result.converged = reason > 0;

  const Processes& processes = parts.interface.processes();
  result.velocities = Vector::Zero(numbering.size);
  with_share(x.get(), result.velocities, [](auto whole, const auto& entries) { whole = entries; });
  processes.add_up({result.velocities.data(), at(numbering.size)});
  Vector product = Vector::Zero(numbering.size);
  product(numbering.rows) = m * Vector(result.velocities(numbering.rows));
  processes.add_up({product.data(), at(numbering.size)});
  result.residual = (result.right_hand_side - product).norm() / result.right_hand_side.norm();
  return result;
}

}  // namespace

BddcSolver bddc(MPI_Comm communicator) {
  const auto all = std::make_shared<const Communicator>(communicator);
  const auto session = std::make_shared<std::shared_ptr<void>>();  // begins at the first call
  return [session, all](const Decomposition& own, const BddcParameters& parameters) {
    if (!*session) *session = slepc_session();
    return solve(own, parameters, *all);
  };
}

}  // namespace nscdd::mpi
