// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include "mpi/petsc.hpp"
#include <nscdd/mpi/slepc.hpp>

namespace nscdd::mpi {
namespace {

constexpr int most_shifts = 200;      // tried for one end
constexpr double between_shifts = 4;  // ratio of successive shifts
constexpr int most_restarts = 300;    // of Krylov-Schur
// A sequential root front (needed for the inertia), detection of null pivots, and workspace for delayed pivots.
constexpr std::pair<PetscInt, PetscInt> mumps_controls[] = {{13, 1}, {24, 1}, {14, 100}};

// Row numbers: rank by rank, the velocities of its subdomains, then an equal share of the interface.
struct PencilLayout {
  PencilLayout(const Communicator& all, Index own_rows, Index interface_rows)
      : own(own_rows), interface(interface_rows), rank(at(all.rank())) {
    const std::size_t size = at(all.size());
    velocities.resize(size);
    MPI_Allgather(&own, 1, MPI_INT64_T, velocities.data(), 1, MPI_INT64_T, all.get());
    for (std::size_t p = 0; p <= size; ++p) share.push_back(interface * static_cast<Index>(p) / all.size());
    for (std::size_t p = 0; p < size; ++p) {
      first.push_back(total);
      total += velocities[p] + share[p + 1] - share[p];
    }
  }
  PetscInt velocity(Index row) const { return static_cast<PetscInt>(first[rank] + row); }
  PetscInt impulse(Index row) const {
    const auto p = at(std::upper_bound(share.begin(), share.end(), row) - share.begin() - 1);
    return static_cast<PetscInt>(first[p] + velocities[p] + row - share[p]);
  }

  Index own, interface, total = 0;
  std::size_t rank;
  std::vector<Index> share, first, velocities;
};

// The contributions of this rank to a symmetric matrix, in both triangles.
struct Entries {
  std::vector<PetscInt> rows, columns;
  std::vector<double> values;
  void add(PetscInt i, PetscInt j, double value) {
    rows.push_back(i);
    columns.push_back(j);
    values.push_back(value);
  }
  void fill(OwnedMatrix& matrix, const Communicator& all, const PencilLayout& layout) {
    check(MatCreate(all.get(), matrix.fill()), "a matrix");
    const auto n = static_cast<PetscInt>(layout.total);
    const auto here = static_cast<PetscInt>(layout.own + layout.share[layout.rank + 1] - layout.share[layout.rank]);
    MatSetSizes(matrix.get(), here, here, n, n);
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

// Calls add(i, j, value) for the entries of all M_E + K_E / flexibility, and tie(row, j, value) for those of all A_E.
void for_networks(const Decomposition& parts, double flexibility, const auto& add, const auto& tie) {
  Index first = 0;
  for (const Subdomain& subdomain : parts.subdomains) {
    const Index size = subdomain.inertia.size();
    for (Index i = 0; i < size; ++i) add(first + i, first + i, subdomain.inertia[i]);
    if (!std::isinf(flexibility)) {
      const SparseMatrix stiffness = SparseMatrix(subdomain.h * subdomain.h.transpose());
      for_entries(stiffness, [&](Index i, Index j, double k) { add(first + i, first + j, k / flexibility); });
    }
    for_entries(subdomain.a, [&](Index row, Index j, double sign) { tie(row, first + j, sign); });
    first += size;
  }
}

// An eigenvalue of (S, P) with its interface impulses.
struct PencilPair {
  double lambda = 0, residual = 0;
  Vector f;
};

// The pencil (K, N) of mpi/slepc.hpp as matrices of PETSc. Throws Error with PETSc's status.
class SlepcPencil {
 public:
  SlepcPencil(const Contraction& b, const Communicator& all, const SpectralOptions& options)
      : b_(b),
        all_(all),
        first_of_p_(dofs(b.system.decomposition())),
        layout_(all, first_of_p_ + dofs(b.preconditioner.decomposition()), b.rows()),
        tolerance_(options.tolerance),
        rows_of_p_(processes().sum(dofs(b.preconditioner.decomposition()))) {
    Entries k, n;
    const auto tie_behind = [&](Index offset) {
      return [&k, this, offset](Index row, Index column, double sign) {
        k.add(layout_.impulse(row), layout_.velocity(offset + column), sign);
        k.add(layout_.velocity(offset + column), layout_.impulse(row), sign);
      };
    };
    const auto add = [&](Index i, Index j, double value) { k.add(layout_.velocity(i), layout_.velocity(j), value); };
    for_networks(b.system.decomposition(), b.system.flexibility(), add, tie_behind(0));
    const auto add_of_p = [&](Index i, Index j, double value) {
      n.add(layout_.velocity(first_of_p_ + i), layout_.velocity(first_of_p_ + j), value);
      add(first_of_p_ + i, first_of_p_ + j, 0);  // the pattern of K contains that of N
    };
    for_networks(b.preconditioner.decomposition(), b.preconditioner.flexibility(), add_of_p, tie_behind(first_of_p_));
    if (all.rank() == 0)  // the pattern has the whole diagonal
      for (Index row = 0; row < layout_.interface; ++row) k.add(layout_.impulse(row), layout_.impulse(row), 0);
    k.fill(k_, all, layout_);
    n.fill(n_, all, layout_);
  }

  // The number of lambda above 1 / tau, by inertia; none if the factorisation breaks down.
  std::optional<Index> above(double tau) {
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

  // The eigenvalue nearest to a shift; none if SLEPc does not find it or breaks down.
  std::optional<PencilPair> nearest(double shift) {
    ++factorisations;
    OwnedSolver owned;
    check(EPSCreate(all_.get(), owned.fill()), "a solver");
    const EPS solver = owned.get();
    prepare(solver, shift);
    PetscInt found = 0;
    if (EPSSolve(solver) != 0 || EPSGetConverged(solver, &found) != 0 || found < 1) return std::nullopt;
    OwnedVector x;
    check(MatCreateVecs(k_.get(), x.fill(), nullptr), "a vector");
    double tau = 0, error = 0;
    check(EPSGetEigenpair(solver, 0, &tau, nullptr, x.get(), nullptr), "an eigenvector");
    check(EPSComputeError(solver, 0, EPS_ERROR_RELATIVE, &error), "its error");
    PencilPair one{1 / tau, 0, impulses(x.get())};
    const double rayleigh = one.f.dot(b_.system.apply(one.f)) / one.f.dot(b_.preconditioner.apply(one.f));
    one.residual = std::max(error * one.lambda, std::abs(rayleigh - one.lambda));
    return one;
  }

  Index factorisations = 0;

 private:
  const Processes& processes() const { return b_.system.decomposition().interface.processes(); }

  void prepare(EPS solver, double shift) const {
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

  // The whole interface part of a vector, on all ranks.
  Vector impulses(Vec x) const {
    Vector f = Vector::Zero(layout_.interface);
    const double* values = nullptr;
    VecGetArrayRead(x, &values);
    const Index first = layout_.share[layout_.rank], last = layout_.share[layout_.rank + 1];
    std::copy_n(values + layout_.own, last - first, f.data() + first);
    VecRestoreArrayRead(x, &values);
    processes().add_up({f.data(), at(f.size())});
    return f;
  }

  const Contraction& b_;
  const Communicator& all_;
  Index first_of_p_;
  PencilLayout layout_;
  double tolerance_;
  Index rows_of_p_;  // of all ranks
  OwnedMatrix k_, n_;
};

// A shift just beyond an end of the spectrum: `wanted` eigenvalues lie above 1 / shift, and 1 / lambda of the end is
// within a factor 1.5 of the shift, nearer than the eigenvalue 0. Searched from `tau` by steps outwards, then inwards.
std::optional<double> shift_next_to_end(SlepcPencil& pencil, double tau, bool low, Index wanted) {
  int shifts = 0;
  bool broken = false;
  const auto beyond = [&](double shift) {
    for (const double nudge : {1.0, 1.01, 0.99}) {
      tau = shift * nudge;
      if (const std::optional<Index> count = pencil.above(tau)) return *count == wanted;
    }
    broken = true;
    return false;
  };
  const double outwards = low ? between_shifts : 1 / between_shifts, inwards = low ? 1 / 1.4 : 1.4;
  while (!beyond(tau)) {
    if (broken || ++shifts > most_shifts) return std::nullopt;
    tau *= outwards;
  }
  double last = tau;
  for (; beyond(last * inwards); last = tau)
    if (++shifts > most_shifts) return std::nullopt;
  if (broken) return std::nullopt;
  return last * (low ? 1.1 : 0.9);  // not on an eigenvalue, as 1 often is
}

SpectralRadius radius(const Contraction& b, const SpectralOptions& options, const Communicator& all) {
  if (b.system.flexibility() == 0) fail("solver slepc: expected epsilon > 0, met 0: shift-invert has the rigid limit");
  const OneBlasThread serial_blas;
  const QuietPetsc quiet;
  SlepcPencil pencil(b, all, options);
  const auto end = [&](double tau, bool low) {  // with its shift
    const std::optional<double> shift = shift_next_to_end(pencil, tau, low, low ? b.rows() : 0);
    return std::pair(shift ? pencil.nearest(*shift) : std::nullopt, shift.value_or(1));
  };
  auto [low, shift] = end(1, true);  // lambda lies on both sides of 1 or next to it
  std::optional<PencilPair> high = end(shift, false).first;
  SpectralRadius result;
  if (!low || !high) return result;
  result.factorisations = pencil.factorisations;
  result.residual = std::max(low->residual, high->residual);
  result.low = {1 - high->lambda};
  result.high = {1 - low->lambda};
  result.mode_min = std::move(high->f);
  result.mode_max = std::move(low->f);
  return result;
}

}  // namespace

SpectrumSolver slepc(MPI_Comm communicator) {
  const auto all = std::make_shared<const Communicator>(communicator);
  const auto session = std::make_shared<std::shared_ptr<void>>();  // begins at the first call
  return [session, all](const Contraction& b, const SpectralOptions& options) {
    if (!*session) *session = slepc_session();
    return radius(b, options, *all);
  };
}

}  // namespace nscdd::mpi
