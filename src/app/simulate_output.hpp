// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/csv.hpp"
#include "formats/trajectory.hpp"
#include "simulation/simulation.hpp"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nscdd::app {

/// What the trajectory of a run says of it and its table must agree with.
struct RunSoFar {
  std::string path;
  std::vector<double> iterations;  ///< of every step done
  bool broke_down = false;         ///< in the step after these, whose rows are in the table
};
RunSoFar run_so_far(const std::string& path);

/// Throws Error if the run cannot go on with the table at `path`: if it has other columns, lacks rows of a
/// step after its first row, or is complete and holds later steps other than the one that broke down. Changes
/// nothing.
void require_table_to_go_on(const std::string& path, const RunSoFar& run);

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
  std::string reasons_of_gain(const Dynamics& dynamics, bool unconverged) const;
  Index steps_ = 0, iterations_ = 0, most_iterations_ = 0, worst_step_ = 0, gaining_steps_ = 0;
  std::map<std::string_view, Index> statuses_;
  double worst_ = 0, boundary_work_ = 0, dissipation_ = 0, numerical_ = 0, overlap_ = 0, gluing_ = 0;
  double gain_ = 0;                                            // energy that contacts added, J
  bool has_interface_ = false;                                 // in any step
  double relative_overlap_ = 0;                                // times the smaller radius
  double setup_seconds_ = 0, solve_seconds_ = 0, visits_ = 0;  // contacts x sweeps
  StepReport last_;
};

/// Throws Error naming the first line in which the case of a trajectory differs from the one asked for (the
/// number of steps aside), and for a trajectory of another build of the program.
void require_same_case(const std::string& path, const TrajectoryHeader& found, const std::string& case_text,
                       const std::string& build);

/// Throws Error naming the disk in which the system of a trajectory differs from the one asked for.
void require_same_disks(const std::string& path, const GranularSystem& found, const GranularSystem& asked);

/// Throws Error naming the disk that did not start where it starts now. `asked` is the state at time 0.
/// Accepts a trajectory that has lost its first step.
void require_same_start(const std::string& path, const GranularState& asked);

}  // namespace nscdd::app
