// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/solved_step.hpp"
#include "two_stage/divided_contacts.hpp"

namespace nscdd {

/// The contact problem of some contacts of a prepared step with the velocities of its bodies.
template <int D>
GlobalFrictionProblem global_problem(const StepProblem<D>& step, const std::vector<GrainContact<D>>& contacts,
                                     const GranularSystem& system) {
  return friction_problem(step.free, contacts, [&](Index body) { return system.rims(step.numbers[at(body)]); });
}

/// The contact problem of a prepared step, u = W r + q. Its impulses are r + pull. The contacts of the law must open.
template <int D>
LocalFrictionProblem contact_problem(const StepProblem<D>& step, const GranularSystem& system) {
  LocalFrictionProblem problem = reduce(global_problem(step, step.contacts, system));
  Vector pull = Vector::Zero(D * problem.contacts());
  for (Index c = 0; c < problem.contacts(); ++c) pull[D * c] = step.contacts[at(c)].pull;
  problem.q -= problem.w * pull;
  return problem;
}

/// Colours of contacts of the next step of a simulation, ascending by (a, b). Greedy: in the order of detection, each
/// takes the least colour of no earlier contact on its free grains. Every rank colours all contacts of the step alike.
ContactColours contact_colours(const Simulation& simulation, const std::vector<StepContact>& contacts);

/// Solves a step that is not decomposed by a contact solver (see solve_friction) on its contact problem. The tolerance
/// is on the natural map. `maximum_iterations` bounds the factorisations, and 100 times as many the sweeps. Sets
/// contacts, velocities, and the entries of the report that the solver knows. An iteration is a check of the solver:
/// ten sweeps, a step along a curve, or one of Newton's.
template <int D>
void solve_whole_contacts(GranularStep<D>& step, const Simulation& simulation, const IterationSink& sink);

/// The same with linear systems cut into subdomains, without W (see DividedContacts). Each rank has the contacts of its
/// subdomains. `parts`: the decomposition of the step.
template <int D>
void solve_divided_contacts(GranularStep<D>& step, GranularDecomposition<D> parts, const Simulation& simulation,
                            const IterationSink& sink);

}  // namespace nscdd
