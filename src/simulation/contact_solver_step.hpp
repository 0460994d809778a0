// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/solved_step.hpp"
#include "two_stage/divided_contacts.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {

/// The contact problem of a prepared step, u = W r + q. With a law that pulls, r + pull are its impulses. The law must
/// open.
template <int D>
LocalFrictionProblem contact_problem(const StepProblem<D>& step, const GranularSystem& system);

/// Colours of contacts of the next step of a simulation, ascending by (a, b). Greedy: in the order in which contacts
/// are found, each takes the least colour that no earlier contact on its free grains has. Every process colours all
/// contacts of the step, and finds the same colours.
ContactColours contact_colours(const Simulation& simulation, const std::vector<StepContact>& contacts);

/// Solves a step that is not decomposed by a contact solver (see solve_friction) on its contact problem u = W r + q.
/// The tolerance is on the natural map. `maximum_iterations` bounds the matrices factorised, and 100 times as many the
/// sweeps. The contacts of the law must open; with one that pulls, r + pull obeys Coulomb's law. Sets contacts,
/// velocities, and the entries of the report that the solver knows. An iteration is a check of the solver: ten sweeps,
/// a step along a curve, or one of Newton's.
template <int D>
void solve_whole_contacts(GranularStep<D>& step, const Simulation& simulation, const IterationSink& sink);

/// The same by a contact solver that cuts its linear systems. It never forms W (see DividedContacts), and several
/// processes each have their share of the contacts. `parts`: the decomposition of the step.
template <int D>
void solve_divided_contacts(GranularStep<D>& step, GranularDecomposition<D> parts, const Simulation& simulation,
                            const IterationSink& sink);

}  // namespace nscdd
