// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/step_solver.hpp"

#include "core/fail.hpp"

namespace nscdd {

void check(const StepSolver& solver) {
  const auto refuse = [](const char* key, std::string_view expected, std::string_view met) {
    throw Error(fmt::format("solver.{}", key), fmt::format("expected {}, met {}", expected, met));
  };
  if (is_contact_solver(solver.algorithm) && solver.tolerance == 0)
    refuse("tolerance", fmt::format("a number > 0 with solver.algorithm {}", to_string(solver.algorithm)), "0");
  if (solver.algorithm == StepAlgorithm::two_stage_newton &&
      solver.interface_preconditioner == SystemPreconditioner::bddc)
    refuse("interface_preconditioner",
           "network, lumped or dirichlet with two_stage_newton, whose systems are not symmetric", "bddc");
  if (solver.criterion != Criterion::gluing) return;
  if (!has_part(solver.algorithm, StepPart::exchanges))
    refuse("criterion", fmt::format("solver.algorithm {} with criterion gluing", algorithms_with(StepPart::exchanges)),
           fmt::format("{}, which has no interface", to_string(solver.algorithm)));
  if (semi_implicit(solver))
    refuse("criterion", "another solver.enrichment with criterion gluing",
           "semi_implicit, which does not iterate on the jumps");
}

}  // namespace nscdd
