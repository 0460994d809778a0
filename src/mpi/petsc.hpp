// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/fail.hpp"
#include "mpi/communicator.hpp"

#include <slepceps.h>

namespace nscdd::mpi {

/// Throws Error unless PETSc returned 0. `what`: the requested result.
inline void check(PetscErrorCode code, std::string_view what) {
  if (code != 0) fail("PETSc: expected {}, met status {}", what, static_cast<int>(code));
}

/// Returns the running session of PETSc and SLEPc, or starts one, which the last copy of the result ends (unless the
/// caller has started it). Not collective: PETSC_COMM_WORLD is this rank, and shared objects have their communicator.
inline std::shared_ptr<void> slepc_session() {
  static std::weak_ptr<void> known;  // one per process
  if (std::shared_ptr<void> running = known.lock()) return running;
  PetscBool begun = PETSC_FALSE;
  SlepcInitialized(&begun);
  const bool begun_before = begun;
  if (!begun_before) {
    PetscInitialized(&begun);
    if (!begun) PETSC_COMM_WORLD = MPI_COMM_SELF;  // otherwise the call is collective
    PetscOptionsSetValue(nullptr, "-no_signal_handler", "true");
    check(SlepcInitializeNoArguments(), "to begin");
  }
  std::shared_ptr<void> session(&known, [begun_before](void*) {
    if (!begun_before && !mpi_has_ended()) SlepcFinalize();
  });
  known = session;
  return session;
}

/// Silences PETSc's error handler while it lives; callers check return codes.
struct QuietPetsc {
  QuietPetsc() { PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr); }
  ~QuietPetsc() { PetscPopErrorHandler(); }
  QuietPetsc(const QuietPetsc&) = delete;
  QuietPetsc& operator=(const QuietPetsc&) = delete;
};

/// Owns an object of PETSc.
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

}  // namespace nscdd::mpi
