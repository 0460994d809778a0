// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/csv.hpp"
#include "formats/trajectory.hpp"
#include "study/lead_in.hpp"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// Sums over the steps of a run, for the lines at its end.
class RunSummary {
 public:
  void add(const StepReport& report);
  std::string text(const Simulation& simulation, const RunOutcome& outcome) const;

 private:
  std::string warnings(const Dynamics& dynamics) const;  ///< what a reader of the numbers must know; often ""
  RunTotals totals_;
  Index steps_ = 0, most_iterations_ = 0, worst_step_ = 0, gaining_steps_ = 0;
  std::map<std::string_view, Index> statuses_;
  double boundary_work_ = 0, dissipation_ = 0, numerical_ = 0, overlap_ = 0;
  double gain_ = 0;                                            // energy that contacts added, J
  bool has_interface_ = false;                                 // in any step
  double relative_overlap_ = 0;                                // times the smaller radius
  double setup_seconds_ = 0, solve_seconds_ = 0, visits_ = 0;  // contacts x sweeps
  StepReport last_;
};

}  // namespace nscdd::app
