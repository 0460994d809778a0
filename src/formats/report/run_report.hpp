// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/trajectory/trajectory.hpp"

namespace nscdd {

/// Everything that the page of a run shows (`nscdd report RUN.h5`): of every step its row of the summary, of the steps
/// drawn where disks and contacts were.

struct DrawnStep {
  Index step = 0;
  double time = 0;                          ///< s
  std::vector<double> x, y, z;              ///< of all grains, m; z in space only
  std::vector<Wall> walls;                  ///< where they are now
  std::vector<TrajectoryContact> contacts;  ///< those with an impulse
};

/// One column of the summary or of the table of iterations.
struct Series {
  Column heading;
  std::vector<double> values;
};

struct RunReport {
  TrajectoryHeader header;
  std::string name;  ///< of the case
  std::string ended;
  StepSolver solver;                ///< what the criterion is, and what it had to fall to
  Index subdomains = 1;             ///< of the partition, those without a contact included
  std::vector<Series> summary;      ///< a value per step, from 1
  std::vector<std::string> status;  ///< how each step ended
  std::vector<Series> iterations;   ///< of the table of iterations: step, iteration, indicators; empty without one
  std::vector<DrawnStep> steps;     ///< ascending
  Index kept = 0;                   ///< steps that the trajectory keeps
};

/// What a table of `nscdd simulate --convergence` says of the steps of the trajectory `run`. Throws Error for a table
/// with other columns, of steps that the run does not have, or of steps that ended elsewhere in another run.
std::vector<Series> read_iterations(const std::string& path, const std::string& run);

/// Of `steps`, ascending, as many as fit into `bytes` of a page: evenly spread, with the first and the last.
std::vector<Index> steps_to_draw(const std::string& path, const std::vector<Index>& steps, double bytes);

/// The report of a trajectory with these steps drawn. None if the monitor asked to stop. Throws Error for a trajectory
/// that has not taken a step, and as the functions of trajectory.hpp.
std::optional<RunReport> report_run(const std::string& path, const std::vector<Index>& steps,
                                    const Monitor& monitor = {});

}  // namespace nscdd
