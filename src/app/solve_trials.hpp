// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/case_options.hpp"
#include "app/tables.hpp"
#include "study/moving/solver_trial.hpp"
#include <nscdd/formats/fclib.hpp>

namespace nscdd::app {

/// A table of solver trials: every contact problem of a folder, or one file, given to every solver of a list.
struct TrialOptions {
  std::string path;  ///< a folder, whose files *.hdf5 and *.h5 count, or one file
  std::vector<FrictionAlgorithm> solvers;
  FrictionSolverOptions solver;  ///< but for the algorithm
  std::optional<double> time_limit;
  std::string csv;
  Reopening how;
};

/// Writes the table, one row per problem and solver, the solvers running fastest, and prints how many problems each
/// solver brought to each of the compared residuals. A file that is no contact problem is named in a note, and
/// its rows have the status "refused". Returns 0, or 1 if files were refused. Throws Error for a folder without files.
int solve_trials(const TrialOptions& options, const Machine& machine);

/// The problem of a file in the unknowns of the contacts; `name` is that of the file, for errors.
LocalFrictionProblem local_problem(const FclibFile& file, const std::string& name);

}  // namespace nscdd::app
