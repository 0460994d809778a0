// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/core/table.hpp>

namespace nscdd {

/// The residuals at which contact solvers are compared. One run to the smallest gives all of them.
inline constexpr std::array compared_residuals{1e-4, 1e-6, 1e-8};

/// What a solver took until something was reached; NaN where it never was.
struct Effort {
  double seconds = not_a_number;  ///< without those of checks
  double work = not_a_number;     ///< in sweeps: operations over 2 per entry of W
};

/// One contact problem given to one contact solver, from zero impulses.
struct SolverTrial {
  FrictionAlgorithm solver = FrictionAlgorithm::automatic;
  Index contacts = 0;
  /// A FrictionStatus; "time_limit" where the time given was over first; "refused" for a problem that cannot be read.
  std::string status = "refused";
  double residual = not_a_number, driven_residual = not_a_number;  ///< of the impulses returned
  Effort all = {};                                                 ///< of the whole run
  double check_seconds = not_a_number;
  Index sweeps = 0, factorisations = 0;
  std::array<Effort, compared_residuals.size()> first =
      {};  ///< until a credible residual was at most compared_residuals[k]
};
const ResultColumns<SolverTrial>& trial_columns();

/// Solves a problem by `options.algorithm`. The run ends at its first check after `time_limit` seconds by the clock,
/// those of checks included, or where `go_on` returns false: its status is then "stopped". Runs are repeated until a
/// tenth of a second is over, ten times at the most, and the shortest counts. Throws Error as solve_friction.
SolverTrial try_solver(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                       double time_limit = infinity, const std::function<bool()>& go_on = {});

/// The solvers of a list of names; "all" stands for every one. Throws Error, beginning with `what`, for an unknown or
/// repeated name.
std::vector<FrictionAlgorithm> contact_solvers_named(const std::vector<std::string>& names, const std::string& what);

}  // namespace nscdd
