// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/contact_problem/contact_solution.hpp"

namespace nscdd {

FclibFile with_result(FclibFile file, const FrictionSolution& found) {
  file.solution.reset();
  if (found.status == FrictionStatus::not_finite) return file;
  FclibSolution result{{}, found.state.velocities, found.impulses};
  if (const auto* global = std::get_if<GlobalFrictionProblem>(&file.problem))
    result.v = body_velocities(*global, found.impulses);
  if (found.status == FrictionStatus::converged)
    file.solution = std::move(result);
  else
    file.guesses.push_back(std::move(result));
  return file;
}

}  // namespace nscdd
