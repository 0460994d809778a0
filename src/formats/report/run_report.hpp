// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/trajectory/trajectory.hpp"

namespace nscdd {

/// A step that the page draws.
struct DrawnStep {
  Index step = 0;
  double time = 0;                          ///< s
  std::vector<double> x, y, z;              ///< of all grains, m; z in space only
  std::vector<Wall> walls;                  ///< at their places in this step
  std::vector<TrajectoryContact> contacts;  ///< those with an impulse or a self-stress
};

/// One column of the summary or of the table of iterations.
struct Series {
  Column heading;
  std::vector<double> values;
};

/// The content of the page of a run (`nscdd report RUN.h5`).
struct RunReport {
  TrajectoryHeader header;
  std::string name;  ///< of the case
  std::string ended;
  StepSolver solver;
  Index subdomains = 1;             ///< of the partition, with or without contacts
  std::vector<Series> summary;      ///< a value per step, from 1
  std::vector<std::string> status;  ///< of each step
  std::vector<Series> iterations;   ///< of the table of iterations, if any: step, iteration, indicators
  std::vector<DrawnStep> steps;     ///< ascending
  Index kept = 0;                   ///< number of kept steps
};

/// Columns of a table of `nscdd simulate --convergence` of the trajectory `run`. Throws Error for a table with other
/// columns, of steps that the run does not have, or of another run.
std::vector<Series> read_iterations(const std::string& path, const std::string& run);

/// As many of the ascending `steps` as fit into `bytes` of a page: evenly spread, with the first and the last.
std::vector<Index> steps_to_draw(const std::string& path, const std::vector<Index>& steps, double bytes);

/// The report of a trajectory that draws `steps`; empty if the monitor asked to stop. Throws Error for a trajectory
/// without a step, and as the functions of trajectory.hpp.
std::optional<RunReport> report_run(const std::string& path, const std::vector<Index>& steps,
                                    const Monitor& monitor = {});

}  // namespace nscdd
