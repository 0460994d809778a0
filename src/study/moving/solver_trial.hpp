// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/core/table.hpp>

namespace nscdd {

struct CaseSpec;
struct Simulation;

/// The residuals at which contact solvers are compared, in one run to the smallest.
inline constexpr std::array compared_residuals{1e-4, 1e-6, 1e-8};

/// The effort of a solver up to a residual; NaN if it was not reached.
struct Effort {
  double seconds = not_a_number;  ///< without those of checks
  double work = not_a_number;     ///< in sweeps: operations over 2 per entry of W
};

/// The run of a contact solver on a contact problem, from zero impulses.
struct SolverTrial {
  FrictionAlgorithm solver = FrictionAlgorithm::automatic;
  Index contacts = 0;
  std::string status = "refused";  ///< a FrictionStatus, "time_limit", or "refused" for a problem that cannot be read
  double residual = not_a_number, driven_residual = not_a_number;  ///< of the impulses returned
  Effort all = {};                                                 ///< of the whole run
  double check_seconds = not_a_number;
  Index sweeps = 0, factorisations = 0;
  std::array<Effort, compared_residuals.size()> first = {};  ///< to a credible residual <= compared_residuals[k]
};
ResultColumns<SolverTrial> trial_columns();

/// Solves a problem by `options.algorithm`. The run ends at its first check after `time_limit` seconds of wall time,
/// those of checks included, or "stopped" if `go_on` returns false. It is repeated until a tenth of a second is over,
/// at most ten times, and the shortest run counts. Throws Error as solve_friction.
SolverTrial try_solver(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                       double time_limit = infinity, const std::function<bool()>& go_on = {});

/// The contact problem of the next step of a simulation.
LocalFrictionProblem whole_contact_problem(const Simulation& simulation);
/// Throws Error for a case whose contacts do not open.
void require_open_contacts(const CaseSpec& spec);

/// The solvers of a list of names; "all" names every one. Throws Error with `what` for an unknown or repeated name.
std::vector<FrictionAlgorithm> contact_solvers_named(const std::vector<std::string>& names, const std::string& what);

}  // namespace nscdd
