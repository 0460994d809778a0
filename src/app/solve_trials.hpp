// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "study/moving/solver_trial.hpp"
#include <nscdd/contact_solvers/verdict.hpp>
#include <nscdd/formats/fclib.hpp>

namespace nscdd::app {

struct SolveOptions {
  std::string file, convergence, output, csv;
  std::vector<std::string> algorithms;  ///< the names given as --solver
  FrictionSolverOptions solver;
  std::optional<double> time_limit;
  Index guess = 0;
  bool verdict = false;  ///< on every problem, not only where a solver fails
  Limits limits;
  Reopening how;
};

/// Writes the table of --csv: a row for each contact problem (of the file, or of the files *.hdf5, *.h5 and *.dat
/// of the folder) and each solver; solvers vary fastest. Prints how many problems each solver brought to each compared
/// residual. A file without a contact problem is noted, and its rows have the status "refused". Returns 1 if there are
/// any, else 0. Throws Error for a folder without files.
int solve_trials(const SolveOptions& options, const Machine& machine);

/// The problem of a file in the unknowns of the contacts; `name`: of the file, for errors.
LocalFrictionProblem local_problem(const FclibFile& file, const std::string& name);

}  // namespace nscdd::app
