// SPDX-License-Identifier: GPL-3.0-or-later
// The definition of solve_contacts, for the sources that instantiate it: one for each class of contact problems.
#pragma once

#include "contact_solvers/admm.hpp"
#include "contact_solvers/automatic.hpp"

namespace nscdd {

/// The solvers in the order of FrictionAlgorithm.
template <ContactProblem P>
constexpr auto contact_solvers = std::to_array<void (*)(P&, SolverRun<P::dimension>&)>({automatic<P>, continuation<P>,
                                                                                        newton<P>, nlgs<P>, admm<P>,
                                                                                        accelerated<P>});

/// Throws Error for a guess of another length and bad options.
void check_options(Index dimension, Index contacts, const FrictionSolverOptions& options, const Vector& guess);

template <ContactProblem P>
FrictionSolution solve_contacts(P& problem, const FrictionSolverOptions& options, const Vector& guess,
                                const FrictionObserver& observer) {
  static_assert(contact_solvers<P>.size() == names_of(FrictionAlgorithm{}).size());
  check_options(P::dimension, problem.data.contacts(), options, guess);
  SolverRun<P::dimension> run(problem, options, guess, observer);
  contact_solvers<P>[static_cast<std::size_t>(FrictionAlgorithm{options.algorithm})](problem, run);
  FrictionSolution solution = run.best();
  // Impulses that grow without end are the answer of sweeps, though smaller ones have smaller natural maps.
  const bool accelerated = options.algorithm == FrictionAlgorithm::accelerated;
  if (options.algorithm == FrictionAlgorithm::nlgs || (accelerated && run.now.state.residual < solution.state.residual))
    solution = run.now;
  solution.unsettled = run.unsettled();
  return solution;
}

}  // namespace nscdd
