// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/solver_run.hpp"
#include "core/fail.hpp"

namespace nscdd {

/// Accelerated projected gradients on a stored W, see apgd.cpp.
template <int D>
void projected_gradients(const ContactBlocks<D>& w, SolverRun<D>& run);

/// Throws Error if W is not stored.
template <ContactProblem P>
void apgd(P& problem, SolverRun<P::dimension>& run) {
  if constexpr (StoredProblem<P>)
    projected_gradients(problem.rows(), run);
  else
    fail("apgd: expected a W that is stored, met one that is not");
}

}  // namespace nscdd
