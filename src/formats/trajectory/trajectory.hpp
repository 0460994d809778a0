// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/output_file.hpp"
#include "simulation/trajectory_step.hpp"

#include <chrono>

namespace nscdd {

/// What a trajectory says of the run it holds. It is the same from the first step to the last.
struct TrajectoryHeader {
  std::string case_text;  ///< the resolved case, as a case file
  std::string build;      ///< build_fingerprint() of the program that wrote it
  Provenance provenance;
  GranularSystem system;
};

/// Writes the trajectory of a run as HDF5. Its layout is in docs/formats.md: /provenance, /case, /system, /steps for
/// the steps that are kept, /last for the newest step, and /summary with a row per step. The file is an
/// AlternatingFile: it holds whole steps at every moment, however the program ends, and can be read while the run goes
/// on. Steps are gathered in memory and reach the file together, with `commit`. Throws Error if the system refuses (no
/// room left, no permission) or another run writes the same file.
class TrajectoryWriter {
 public:
  /// Begins a new trajectory with the state `first`. A file of that name is replaced.
  TrajectoryWriter(const std::string& path, const TrajectoryHeader& header, const TrajectoryStep& first,
                   const std::vector<Column>& summary_columns);

  /// Takes an existing trajectory to go on with it. Nothing is changed yet, but nobody else can write it now.
  TrajectoryWriter(const std::string& path, const std::vector<Column>& summary_columns);
  ~TrajectoryWriter();  ///< commits, if the system lets it
  TrajectoryWriter(const TrajectoryWriter&) = delete;
  TrajectoryWriter& operator=(const TrajectoryWriter&) = delete;

  /// To be called first for an existing trajectory. `case_text` replaces its own, because it may ask for more
  /// steps. The line `restart` is added to those of earlier restarts in provenance/restarts.
  void go_on(const std::string& case_text, const std::string& restart);

  /// Adds a step to /last, and to /steps if `keep`, and the rows of it and of steps before it to /summary. It is in the
  /// file from the next `commit` on.
  void append(TrajectoryStep step, const std::vector<Row>& summary, bool keep);

  /// Whether a second has passed since the last commit. Steps should not stay out of the file for longer.
  bool due() const;

  /// Brings the file up to date.
  void commit();

  /// Commits, and says in the attribute `ended` how the run ended.
  void end(const std::string& how);

 private:
  /// What the file lacks. Of the steps that are not kept only the newest one is needed, for /last.
  struct Pending {
    std::vector<TrajectoryStep> steps{};
    bool newest_kept = true;
    Table summary{};
    std::string ended{};
  };
  AlternatingFile file_;
  Pending pending_;
  std::chrono::steady_clock::time_point committed_ = std::chrono::steady_clock::now();
};

/// Reading. Every function throws Error naming the file if it is not a trajectory or is damaged.
TrajectoryHeader read_trajectory_header(const std::string& path);

/// Numbers of the steps kept in /steps, ascending.
std::vector<Index> trajectory_steps(const std::string& path);

/// A step that is kept. For any other throws Error naming the steps that are.
TrajectoryStep read_trajectory_step(const std::string& path, Index step);

/// The newest step: what a run goes on from.
TrajectoryStep read_last_step(const std::string& path);

/// A step that is kept in /steps or is the newest one; nothing for any other.
std::optional<TrajectoryStep> find_trajectory_step(const std::string& path, Index step);

/// The name that the case of the run had: the trajectory keeps only the text of the case.
std::string name_of_case(const std::string& path, const TrajectoryHeader& header);

/// The simulation a trajectory holds, in a state of it: system and boundaries as in the file, laws and solver
/// from its case text. Packing files and settled cases that it began from are not needed. Throws Error if
/// case text, system and state do not fit together.
Simulation rebuilt_simulation(const std::string& path, const TrajectoryHeader& header, GranularState state);

/// Throws Error naming the file, and the disk or boundary, if system and state read from it do not fit
/// together or a position or velocity is not a number.
void require_fit(const std::string& path, const Simulation& simulation);

/// How the run ended, as its attribute `ended` says.
std::string read_end(const std::string& path);

/// A column of numbers of /summary, one per step from 1.
std::vector<double> read_summary(const std::string& path, const std::string& column);
/// Whether /summary has a column: trajectories of older versions lack some.
bool has_summary(const std::string& path, const std::string& column);
/// The column `status` of /summary: how each step ended.
std::vector<std::string> read_statuses(const std::string& path);

/// Whether a file is one of HDF5 that has the groups of a trajectory. False for a file that is not there.
bool holds_trajectory(const std::string& path);

}  // namespace nscdd
