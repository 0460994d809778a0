// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/csv.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "study/case/lead_in.hpp"

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

/// The files that a run writes, and how.
struct RunFiles {
  std::string output, convergence;         ///< the trajectory; the table of iterations, empty for none
  Index save_every = 1;                    ///< steps, of the trajectory
  std::optional<Index> convergence_every;  ///< iterations; without it about ten per decade
  bool force = false;                      ///< replace what is there
};

/// Writes the outputs of a run while it goes on. The first process writes. All processes make these calls, and an error
/// of the first is thrown in all.
class RunOutput {
 public:
  /// Both must outlive this.
  RunOutput(const RunFiles& files, const Processes& processes) : files_(files), processes_(processes) {}

  /// `found`: the run that is continued.
  void open(const TrajectoryHeader& header, const Simulation& simulation, const std::optional<RunSoFar>& found,
            const std::string& command_line);
  /// Looks at no iteration unless there is a table, and then in all processes.
  IterationSink iterations();
  void add(const Simulation& after, const AnySolvedStep& solved, const StepReport& report);
  void end(const RunOutcome& outcome);

 private:
  void first(const std::function<void()>& work);
  void hand_over(bool keep);

  const RunFiles& files_;
  const Processes& processes_;
  std::optional<TrajectoryWriter> trajectory_;
  std::optional<CsvWriter> table_;
  std::optional<Error> failure_;  // of the table, in the middle of a step
  // The newest step with the contacts of this process, until the first one gathers them, and rows of steps since it
  // did.
  std::optional<TrajectoryStep> newest_;
  std::vector<Row> rows_;
};

}  // namespace nscdd::app
