// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/csv.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "study/case/lead_in.hpp"

namespace nscdd::app {

/// The run to continue, from its trajectory.
struct RunSoFar {
  std::string path;
  std::vector<double> iterations;  ///< of each completed step
  std::vector<double> speeds;      ///< mean speed after each step, m/s
  bool failed = false;             ///< in the next step, whose rows are in the table
};
RunSoFar run_so_far(const std::string& path);

/// Throws Error unless the trajectory at `path` holds a run of this case (the number of steps aside) and of this build
/// with at most as many steps, and the run can continue the --convergence table at `table`. It cannot if that has other
/// columns, lacks rows of a step after its first row, or is complete and holds later steps (except the one that
/// failed). The grains are checked by take_up.
void check_restart(const std::string& path, const std::string& table, const CaseSpec& spec);

/// Gives a simulation at time 0 the last state of the trajectory at `path`. Throws Error naming the disk that differs
/// there or started elsewhere (unless the trajectory has lost its first step).
void take_up(Simulation& simulation, const std::string& path);

/// A warning about steps whose boundaries may leave no room (no_room); empty if there are none.
std::string lack_of_room(const RunTotals& totals);

/// The report that ends a run, with its warnings.
std::string report_text(const RunTotals& totals, const Simulation& simulation, const RunOutcome& outcome);

/// The output files of a run.
struct RunFiles {
  std::string output, convergence;         ///< the trajectory; the table of iterations, empty for none
  Index save_every = 1;                    ///< interval of kept steps
  std::optional<Index> convergence_every;  ///< interval of iterations with a row; by default about ten per decade
  bool force = false;                      ///< replace existing files
};

/// Writes the outputs of a run on rank 0. All calls are collective: an error of rank 0 is thrown on all ranks.
class RunOutput {
 public:
  /// Both must outlive this.
  RunOutput(const RunFiles& files, const Processes& processes) : files_(files), processes_(processes) {}

  /// `found`: the run to continue.
  void open(const TrajectoryHeader& header, const Simulation& simulation, const std::optional<RunSoFar>& found,
            const std::string& command_line);
  IterationSink iterations();  ///< empty without a table
  void add(const Simulation& after, const AnySolvedStep& solved, const StepReport& report);
  void end(const RunOutcome& outcome);

 private:
  void first(const std::function<void()>& work);
  void hand_over(bool keep);

  const RunFiles& files_;
  const Processes& processes_;
  std::optional<TrajectoryWriter> trajectory_;
  std::optional<CsvWriter> table_;
  std::optional<Error> failure_;          // of the table, in the middle of a step
  std::optional<TrajectoryStep> newest_;  // with the contacts of this rank, until rank 0 gathers them
  std::vector<Row> rows_;                 // of the steps not yet appended
};

}  // namespace nscdd::app
