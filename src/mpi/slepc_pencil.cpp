// SPDX-License-Identifier: GPL-3.0-or-later
#include "mpi/slepc_pencil.hpp"

#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"

#include <numeric>

namespace nscdd::mpi {
namespace {

constexpr int most_restarts = 300;  // of Krylov-Schur
// The last front is factorised like all others, for its inertia; null pivots are found; room for delayed ones.
constexpr std::pair<PetscInt, PetscInt> mumps_controls[] = {{13, 1}, {24, 1}, {14, 100}};

void check(PetscErrorCode code, std::string_view what) {
  if (code != 0) fail("SLEPc: expected {}, met status {}", what, static_cast<int>(code));
}

// Entries of a symmetric matrix that processes add to, both triangles.
struct Entries {
  std::vector<PetscInt> rows, columns;
  std::vector<double> values;
  void add(PetscInt i, PetscInt j, double value) {
    rows.push_back(i);
    columns.push_back(j);
    values.push_back(value);
  }
  void add_both(PetscInt i, PetscInt j, double value) {
    add(i, j, value);
    add(j, i, value);
  }
  void fill(OwnedMatrix& matrix, const Communicator& all, const PencilLayout& layout) {
    check(MatCreate(all.get(), matrix.fill()), "a matrix");
    const auto n = static_cast<PetscInt>(layout.total);
    MatSetSizes(matrix.get(), layout.rows_here(), layout.rows_here(), n, n);
    MatSetType(matrix.get(), MATAIJ);
    check(MatSetPreallocationCOO(matrix.get(), static_cast<PetscCount>(rows.size()), rows.data(), columns.data()),
          "room for a matrix");
    check(MatSetValuesCOO(matrix.get(), values.data(), ADD_VALUES), "the entries of a matrix");
    MatSetOption(matrix.get(), MAT_SYMMETRIC, PETSC_TRUE);
    MatSetOption(matrix.get(), MAT_SYMMETRY_ETERNAL, PETSC_TRUE);
  }
};

Index dofs(const Decomposition& parts) {
  return std::accumulate(parts.subdomains.begin(), parts.subdomains.end(), Index{0},
                         [](Index sum, const Subdomain& one) { return sum + one.inertia.size(); });
}

// Calls add(i, j, value) for the entries of all M_E + K_E / flexibility.
template <class Add>
void for_networks(const Decomposition& parts, double flexibility, const Add& add) {
  Index first = 0;
  for (const Subdomain& subdomain : parts.subdomains) {
    const Index size = subdomain.inertia.size();
    for (Index i = 0; i < size; ++i) add(first + i, first + i, subdomain.inertia[i]);
    if (!std::isinf(flexibility)) {
      const SparseMatrix stiffness = SparseMatrix(subdomain.h * subdomain.h.transpose());
      for_entries(stiffness, [&](Index i, Index j, double k) { add(first + i, first + j, k / flexibility); });
    }
    first += size;
  }
}

}  // namespace

SlepcSession::SlepcSession() {
  PetscBool begun = PETSC_FALSE;
  SlepcInitialized(&begun);
  if (begun) return;
  PetscInitialized(&begun);
  if (!begun) PETSC_COMM_WORLD = MPI_COMM_SELF;  // otherwise all processes of the program would be waited for
  PetscOptionsSetValue(nullptr, "-no_signal_handler", "true");
  check(SlepcInitializeNoArguments(), "to begin");
  begun_here_ = true;
}

SlepcSession::~SlepcSession() {
  int finalised = 0;
  MPI_Finalized(&finalised);
  if (begun_here_ && finalised == 0) SlepcFinalize();
}

std::shared_ptr<const SlepcSession> SlepcSession::present() {
  static std::weak_ptr<const SlepcSession> known;  // it belongs to the process
  std::shared_ptr<const SlepcSession> session = known.lock();
  if (!session) known = session = std::make_shared<const SlepcSession>();
  return session;
}

PencilLayout::PencilLayout(const Communicator& all, Index own_rows, Index interface_rows)
    : own(own_rows), interface(interface_rows) {
  const auto size = static_cast<std::size_t>(all.size());
  std::vector<long> rows(size);
  const long mine = own;
  MPI_Allgather(&mine, 1, MPI_LONG, rows.data(), 1, MPI_LONG, all.get());
  for (std::size_t p = 0; p <= size; ++p) share.push_back(interface * static_cast<Index>(p) / all.size());
  for (std::size_t p = 0; p < size; ++p) {
    first.push_back(total);
    velocities.push_back(rows[p]);
    total += rows[p] + share[p + 1] - share[p];
  }
  rank = static_cast<std::size_t>(all.rank());
}

PetscInt PencilLayout::impulse(Index row) const {
  const auto p = static_cast<std::size_t>(std::upper_bound(share.begin(), share.end(), row) - share.begin() - 1);
  return static_cast<PetscInt>(first[p] + velocities[p] + row - share[p]);
}

SlepcPencil::SlepcPencil(const Contraction& b, const std::shared_ptr<const Communicator>& all,
                         const SpectralOptions& options)
    : b_(b),
      all_(all),
      first_of_p_(dofs(b.system.decomposition())),
      layout_(*all, first_of_p_ + dofs(b.preconditioner.decomposition()), b.rows()),
      tolerance_(options.tolerance),
      rows_of_p_(processes().sum(dofs(b.preconditioner.decomposition()))) {
  assemble();
}

std::optional<Index> SlepcPencil::above(double tau) {
  ++factorisations;
  OwnedMatrix shifted, factor;
  MatFactorInfo information;
  MatFactorInfoInitialize(&information);
  check(MatDuplicate(k_.get(), MAT_COPY_VALUES, shifted.fill()), "a copy of a matrix");
  check(MatAXPY(shifted.get(), -tau, n_.get(), SUBSET_NONZERO_PATTERN), "a shifted matrix");
  check(MatGetFactor(shifted.get(), MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, factor.fill()), "MUMPS");
  for (const auto& [control, value] : mumps_controls) MatMumpsSetIcntl(factor.get(), control, value);
  check(MatCholeskyFactorSymbolic(factor.get(), shifted.get(), nullptr, &information), "an analysis");
  check(MatCholeskyFactorNumeric(factor.get(), shifted.get(), &information), "a factor");
  MatFactorError error = MAT_FACTOR_NOERROR;
  MatFactorGetError(factor.get(), &error);
  if (error != MAT_FACTOR_NOERROR) return std::nullopt;
  PetscInt negative = 0;
  check(MatGetInertia(factor.get(), &negative, nullptr, nullptr), "an inertia");
  return static_cast<Index>(negative) - rows_of_p_;
}

std::optional<PencilPair> SlepcPencil::nearest(double shift) {
  ++factorisations;
  OwnedSolver solver;
  prepare(solver, shift);
  PetscInt found = 0;
  if (EPSSolve(solver.get()) != 0 || EPSGetConverged(solver.get(), &found) != 0 || found < 1) return std::nullopt;
  OwnedVector x;
  check(MatCreateVecs(k_.get(), x.fill(), nullptr), "a vector");
  double tau = 0, error = 0;
  check(EPSGetEigenpair(solver.get(), 0, &tau, nullptr, x.get(), nullptr), "an eigenvector");
  check(EPSComputeError(solver.get(), 0, EPS_ERROR_RELATIVE, &error), "its error");
  PencilPair one{1 / tau, 0, impulses(x.get())};
  const double rayleigh = one.f.dot(b_.system.apply(one.f)) / one.f.dot(b_.preconditioner.apply(one.f));
  one.residual = std::max(error * one.lambda, std::abs(rayleigh - one.lambda));
  return one;
}

void SlepcPencil::assemble() {
  Entries k, n;
  for_networks(b_.system.decomposition(), b_.system.flexibility(),
               [&](Index i, Index j, double value) { k.add(layout_.velocity(i), layout_.velocity(j), value); });
  for_networks(b_.preconditioner.decomposition(), b_.preconditioner.flexibility(), [&](Index i, Index j, double value) {
    n.add(layout_.velocity(first_of_p_ + i), layout_.velocity(first_of_p_ + j), value);
    k.add(layout_.velocity(first_of_p_ + i), layout_.velocity(first_of_p_ + j), 0);  // one pattern holds the other
  });
  for (const auto& [parts, offset] :
       {std::pair(&b_.system.decomposition(), Index{0}), std::pair(&b_.preconditioner.decomposition(), first_of_p_)}) {
    Index first = offset;
    for (const Subdomain& subdomain : parts->subdomains) {
      for_entries(subdomain.a, [&](Index row, Index column, double sign) {
        k.add_both(layout_.impulse(row), layout_.velocity(first + column), sign);
      });
      first += subdomain.inertia.size();
    }
  }
  if (all_->rank() == 0)  // a place for every pivot
    for (Index row = 0; row < layout_.interface; ++row) k.add(layout_.impulse(row), layout_.impulse(row), 0);
  k.fill(k_, *all_, layout_);
  n.fill(n_, *all_, layout_);
}

void SlepcPencil::prepare(OwnedSolver& owned, double shift) {
  check(EPSCreate(all_->get(), owned.fill()), "a solver");
  const EPS solver = owned.get();
  EPSSetOperators(solver, k_.get(), n_.get());
  EPSSetProblemType(solver, EPS_GHEP);
  EPSSetType(solver, EPSKRYLOVSCHUR);
  EPSSetTarget(solver, shift);
  EPSSetWhichEigenpairs(solver, EPS_TARGET_MAGNITUDE);
  EPSSetDimensions(solver, 1, PETSC_DEFAULT, PETSC_DEFAULT);
  EPSSetTolerances(solver, 0.01 * tolerance_, most_restarts);
  EPSSetOptionsPrefix(solver, "nscdd_");
  ST transform = nullptr;
  KSP linear = nullptr;
  PC factors = nullptr;
  EPSGetST(solver, &transform);
  STSetType(transform, STSINVERT);
  STSetMatStructure(transform, SUBSET_NONZERO_PATTERN);
  STGetKSP(transform, &linear);
  KSPSetType(linear, KSPPREONLY);
  KSPGetPC(linear, &factors);
  PCSetType(factors, PCCHOLESKY);
  PCFactorSetMatSolverType(factors, MATSOLVERMUMPS);
  for (const auto& [control, value] : mumps_controls)
    PetscOptionsSetValue(nullptr, fmt::format("-nscdd_st_mat_mumps_icntl_{}", control).c_str(),
                         std::to_string(value).c_str());
  check(EPSSetFromOptions(solver), "its options");
}

// The interface part of a vector, whole in every process.
Vector SlepcPencil::impulses(Vec x) const {
  Vector f = Vector::Zero(layout_.interface);
  const double* values = nullptr;
  VecGetArrayRead(x, &values);
  const Index first = layout_.share[layout_.rank], last = layout_.share[layout_.rank + 1];
  for (Index row = first; row < last; ++row) f[row] = values[layout_.own + row - first];
  VecRestoreArrayRead(x, &values);
  processes().add_up({f.data(), static_cast<std::size_t>(f.size())});
  return f;
}

}  // namespace nscdd::mpi
