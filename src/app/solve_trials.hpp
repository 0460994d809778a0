// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "study/moving/solver_trial.hpp"
#include <nscdd/contact_solvers/verdict.hpp>
#include <nscdd/formats/fclib.hpp>

namespace nscdd::app {

/// A table of solver trials: each contact problem of a folder, or one file, by each solver of a list.
struct TrialOptions {
  std::string path;  ///< a file, or a folder of files *.hdf5, *.h5 and *.dat
  std::vector<FrictionAlgorithm> solvers;
  FrictionSolverOptions solver;  ///< except the algorithm
  std::optional<double> time_limit;
  bool verdict = false;  ///< on every problem, not only where a solver fails
  std::string csv;
  Reopening how;
};

/// Writes the table, a row per problem and solver (solvers vary fastest), and prints how many problems each solver
/// brought to each compared residual. A file without a contact problem is noted, and its rows have the status
/// "refused". Returns 1 if there are any, else 0. Throws Error for a folder without files.
int solve_trials(const TrialOptions& options, const Machine& machine);

/// The problem of a file in the unknowns of the contacts; `name`: of the file, for errors.
LocalFrictionProblem local_problem(const FclibFile& file, const std::string& name);

}  // namespace nscdd::app
