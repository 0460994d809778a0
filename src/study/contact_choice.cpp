// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/range_projector.hpp"
#include "linalg/sparse_entries.hpp"
#include "mechanics/active_set.hpp"
#include <nscdd/study/model.hpp>

#include <algorithm>

namespace nscdd {
namespace {

// Impulses are unique if the columns of H of all contacts that stay closed are independent. This condition is
// sufficient. Impulses may be unique without it, if every self-stress needs an idle contact; that case is not
// looked for.
bool unique_impulses(const ReferenceProblem& problem, const std::vector<UnilateralStatus>& status) {
  std::vector<Index> closed;
  std::vector<char> touched(at(problem.grains()), 0);
  for (Index c = 0; c < problem.contacts(); ++c) {
    if (status[at(c)] == UnilateralStatus::open) continue;
    for (const Index grain : grains_of_contact(problem, c)) touched[at(grain)] = 1;
    closed.push_back(c);
  }
  if (closed.empty()) return true;
  // Two translations and a rotation are invisible to contacts. More columns than the other motions cannot be
  // independent; counting them spares large packings a factorisation.
  const Index grains = std::count(touched.begin(), touched.end(), 1);
  if (count(closed) > problem.dofs_per_grain * grains - 3) return false;
  return sparse_rank(selected_columns(problem.h, closed)) == count(closed);
}

}  // namespace

ContactChoice choose_contacts(const Model& model, ContactSet contacts) {
  const ReferenceProblem& problem = model.problem;
  if (contacts == ContactSet::all)
    return {.active = std::vector<char>(at(problem.contacts()), 1), .impulses = {}, .rule = "all", .solution = "none"};
  if (problem.columns_per_contact > 1)
    fail("{}: expected --contacts all for a problem with friction, met {}: its rule is that of frictionless contacts",
         model.name, to_string(contacts));
  if (contacts == ContactSet::active) {
    const RigidImpulses rigid = rigid_impulses(problem);
    return {.active = active_contacts(problem, rigid),
            .impulses = rigid.impulses,
            .rule = rigid.unique ? "compressive (unique)" : "compressive (least norm)",
            .solution = rigid.unique ? "unique" : "least_norm",
            .certain = rigid.residual <= 1e-8};
  }
  require_arriving_velocity(problem);
  const UnilateralImpulses solved = unilateral_impulses(problem);
  const bool unique = unique_impulses(problem, solved.status);
  std::vector<char> carrying;
  for (const UnilateralStatus status : solved.status) carrying.push_back(status == UnilateralStatus::carrying);
  return {.active = carrying,
          .impulses = solved.impulses,
          .rule = unique ? "complementarity (unique)" : "complementarity (maximal)",
          .solution = unique ? "unilateral_unique" : "unilateral_maximal",
          .idle = solved.count(UnilateralStatus::idle),
          .certain = solved.converged};
}

}  // namespace nscdd
