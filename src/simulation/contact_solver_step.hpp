// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {

/// The contact problem of a prepared step, u = W r + q. With a law that pulls, r + pull are its impulses. The law must
/// open.
template <int D>
LocalFrictionProblem contact_problem(const StepProblem<D>& step, const GranularSystem& system);

/// Solves a prepared step by a contact solver (see solve_friction) on its contact problem u = W r + q. One that cuts
/// its linear systems never forms W (see DividedContacts), and several processes each have their share of the contacts.
/// `parts`: the cut of the step. The tolerance is on the natural map. `maximum_iterations` bounds the matrices
/// factorised, and 100 times as many the sweeps. The contacts of the law must open; with one that pulls, r + pull
/// obeys Coulomb's law. Sets contacts, velocities, and of the report what the solver knows. An iteration is a check of
/// the solver: ten sweeps, a step along a curve, or one of Newton's.
template <int D>
void solve_by_contact_solver(SolvedStep<D>& step, GranularDecomposition<D> parts, const Simulation& simulation,
                             const IterationSink& sink);

}  // namespace nscdd
