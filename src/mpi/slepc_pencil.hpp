// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mpi/communicator.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <slepceps.h>

namespace nscdd::mpi {

/// PETSc and SLEPc, begun for this process as long as it lives, unless the caller has begun them already. Other
/// processes need not take part: the world of PETSc is this process alone, and what processes share names them.
class SlepcSession {
 public:
  SlepcSession();
  ~SlepcSession();
  SlepcSession(const SlepcSession&) = delete;
  SlepcSession& operator=(const SlepcSession&) = delete;

  /// Returns the running session, or starts one.
  static std::shared_ptr<const SlepcSession> present();

 private:
  bool begun_here_ = false;
};

/// Silences PETSc's error handler while it lives; callers check return codes.
class QuietPetsc {
 public:
  QuietPetsc() { PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr); }
  ~QuietPetsc() { PetscPopErrorHandler(); }
  QuietPetsc(const QuietPetsc&) = delete;
  QuietPetsc& operator=(const QuietPetsc&) = delete;
};

/// An object of PETSc, destroyed with this one.
template <class Handle, PetscErrorCode (*destroy)(Handle*)>
class Owned {
 public:
  Owned() = default;
  ~Owned() { destroy(&handle_); }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  Handle get() const { return handle_; }
  Handle* fill() { return &handle_; }

 private:
  Handle handle_ = nullptr;
};
using OwnedMatrix = Owned<Mat, MatDestroy>;
using OwnedVector = Owned<Vec, VecDestroy>;
using OwnedSolver = Owned<EPS, EPSDestroy>;

/// Numbers of the rows: process by process, each with its velocities and an equal share of the interface behind them.
struct PencilLayout {
  PencilLayout(const Communicator& all, Index own_rows, Index interface_rows);
  PetscInt velocity(Index row) const { return static_cast<PetscInt>(first[rank] + row); }
  PetscInt impulse(Index row) const;
  PetscInt rows_here() const { return static_cast<PetscInt>(own + share[rank + 1] - share[rank]); }

  Index own, interface, total = 0;
  std::size_t rank = 0;
  std::vector<Index> share, first, velocities;
};

/// One eigenvalue of (S, P).
struct PencilPair {
  double lambda = 0, residual = 0;
  Vector f;  ///< interface impulses
};

/// The pencil (K, N) of a contraction whose subdomains processes share, of eigenvalues tau = 1 / lambda and 0
/// (docs/machines.md), in matrices of PETSc, and what SLEPc and MUMPS find of it. Throws Error with PETSc's status.
class SlepcPencil {
 public:
  SlepcPencil(const Contraction& b, const std::shared_ptr<const Communicator>& all, const SpectralOptions& options);

  /// How many lambda lie above 1 / tau, counted by inertia; none if the factorisation broke down.
  std::optional<Index> above(double tau);

  /// The eigenvalue next to a shift; none if SLEPc does not find it or breaks down.
  std::optional<PencilPair> nearest(double shift);

  Index factorisations = 0;

 private:
  const Processes& processes() const { return b_.system.decomposition().interface.processes(); }
  void assemble();
  void prepare(OwnedSolver& owned, double shift);
  Vector impulses(Vec x) const;

  const Contraction& b_;
  std::shared_ptr<const Communicator> all_;
  Index first_of_p_;
  PencilLayout layout_;
  double tolerance_;
  Index rows_of_p_;  // of all processes
  OwnedMatrix k_, n_;
};

}  // namespace nscdd::mpi
