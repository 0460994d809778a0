// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/csv.hpp"
#include "formats/trajectory.hpp"
#include "study/lead_in.hpp"

namespace nscdd::app {

/// A run that is continued: what its trajectory says of it and its table must agree with.
struct RunSoFar {
  std::string path;
  std::vector<double> iterations;  ///< of every step done
  std::vector<double> kinetic;     ///< energy after every step, J
  bool broke_down = false;         ///< in the step after these, whose rows are in the table
};
RunSoFar run_so_far(const std::string& path);

/// Throws Error unless the trajectory at `path` holds a run of this case (the number of steps aside) and of this
/// build of the program with no more steps than asked for, and the run can go on with the table of --convergence
/// at `table`. It cannot if that has other columns, lacks rows of a step after its first row, or is complete and
/// holds later steps other than the one that broke down. Changes nothing. The grains are not known yet.
void check_restart(const std::string& path, const std::string& table, const CaseSpec& spec);

/// Gives a simulation at time 0 the last state of the trajectory at `path`. Throws Error naming the disk that is
/// another one there, or did not start where it starts now (unless the trajectory has lost its first step).
void take_up(Simulation& simulation, const std::string& path);

/// The table of --convergence: one row per iteration looked at; none if `path` is empty. Where a `run` is
/// continued, it keeps the rows of the steps that are done and drops those of the step that was not.
std::unique_ptr<CsvWriter> convergence_table(const std::string& path, bool force, const std::optional<RunSoFar>& run);

/// The lines at the end of a run, among them warnings that a reader of the numbers must know.
std::string report_text(const RunTotals& totals, const Simulation& simulation, const RunOutcome& outcome);

}  // namespace nscdd::app
