// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/linalg/inertia_factor.hpp>

#include <memory>

namespace nscdd::testing {

/// Sequential MUMPS (P. R. Amestoy, I. S. Duff, J.-Y. L'Excellent, J. Koster, SIAM J. Matrix Anal. Appl. 23
/// (2001) 15-41; www.mumps-solver.org) in the place of our own factorisation. Unlike ours it delays pivots
/// from front to front, so that every pivot has at least `pivot_threshold` of the size of its column.
InertiaMethod mumps(double pivot_threshold = 0.01);

/// What a judge has seen.
struct MumpsVerdict {
  Index judged = 0;     ///< counts that both methods could be relied on for
  Index differing = 0;  ///< of these
  Index undecided = 0;  ///< counts of the first method that the judge has no reliable one for
};

/// Factorises with `method` and holds each count that can be relied on against that of `judge`.
InertiaMethod judged(InertiaMethod method, InertiaMethod judge, std::shared_ptr<MumpsVerdict> verdict);

}  // namespace nscdd::testing
