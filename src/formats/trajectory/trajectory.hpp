// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/output_file.hpp"
#include "simulation/trajectory_step.hpp"

#include <chrono>

namespace nscdd {

/// What all steps of a trajectory share.
struct TrajectoryHeader {
  std::string case_text;  ///< the resolved case, as a case file
  std::string build;      ///< build_fingerprint() of the program that wrote it
  Provenance provenance;
  GranularSystem system;
};

/// Writes the trajectory of a run as HDF5 (docs/formats.md): /provenance, /case, /system, /steps for the kept steps,
/// /last for the newest step, and /summary with a row per step. The file is an AlternatingFile: it holds whole steps
/// at every moment and can be read during the run. Steps are gathered in memory until `commit`. Throws Error if the
/// system refuses (no room left, no permission) or another run writes the same file.
class TrajectoryWriter {
 public:
  /// Begins a new trajectory with the state `first`; replaces a file of that name.
  TrajectoryWriter(const std::string& path, const TrajectoryHeader& header, const TrajectoryStep& first,
                   const std::vector<Column>& summary_columns);

  /// Locks an existing trajectory to continue it, and changes nothing yet.
  TrajectoryWriter(const std::string& path, const std::vector<Column>& summary_columns);
  ~TrajectoryWriter();  ///< commits, if the system lets it

  /// Must be called first for an existing trajectory. `case_text` replaces its own, because it may have more steps.
  /// The line `restart` joins those of earlier restarts in provenance/restarts, and `chains` replace all of the file.
  void go_on(const std::string& case_text, const std::string& restart, const std::vector<ChainContact>& chains = {});

  /// Adds a step to /last and, if `keep`, to /steps, and its row and those of steps before it to /summary.
  void append(TrajectoryStep step, const std::vector<Row>& summary, bool keep);

  void append(const std::vector<ChainContact>& chain);  ///< of a step without a solution, taken or not

  bool due() const;  ///< a second has passed since the last commit
  void commit();     ///< brings the file up to date

  /// Commits, with the attribute `ended`: how the run ended.
  void end(const std::string& how);

 private:
  /// What the file lacks: kept steps, and the newest one for /last.
  struct Pending {
    std::vector<TrajectoryStep> steps{};
    bool newest_kept = true;
    Table summary{};
    std::vector<ChainContact> chains{};
    std::string ended{};
  };
  AlternatingFile file_;
  Pending pending_;
  std::chrono::steady_clock::time_point committed_ = std::chrono::steady_clock::now();
};

/// Reading. All functions throw Error naming the file if it is not a trajectory or is damaged.
TrajectoryHeader read_trajectory_header(const std::string& path);

/// Numbers of the kept steps, ascending.
std::vector<Index> trajectory_steps(const std::string& path);

/// A kept step. Throws Error naming the kept steps for any other.
TrajectoryStep read_trajectory_step(const std::string& path, Index step);

/// The newest step, from which a run continues.
TrajectoryStep read_last_step(const std::string& path);

/// A step that is kept or is the newest one; empty for any other.
std::optional<TrajectoryStep> find_trajectory_step(const std::string& path, Index step);

/// The chains of the steps up to `last` that have no solution.
std::vector<ChainContact> read_chains(const std::string& path, Index last = std::numeric_limits<Index>::max());

/// Gives the contacts of a kept step the self-stress of its chain. The last one also has the chain of a step that was
/// not taken. Contacts of a chain that the step lacks are added, without an impulse.
void add_chain(const std::string& path, TrajectoryStep& step);

/// The name of the case of the run.
std::string name_of_case(const std::string& path, const TrajectoryHeader& header);

/// The simulation of a trajectory in one of its states: system and boundaries from the file, laws and solver from its
/// case text; packing files and settled cases are not read. Throws Error if these do not fit together.
Simulation rebuilt_simulation(const std::string& path, const TrajectoryHeader& header, GranularState state);

/// Throws Error naming the file, and the disk or boundary, if system and state read from it do not fit together or a
/// position or velocity is not a number.
void require_fit(const std::string& path, const Simulation& simulation);

/// The attribute `ended`.
std::string read_end(const std::string& path);

/// A column of numbers of /summary, one per step from 1.
std::vector<double> read_summary(const std::string& path, const std::string& column);
/// Whether /summary has a column: trajectories of older versions lack some.
bool has_summary(const std::string& path, const std::string& column);
/// The column `status` of /summary.
std::vector<std::string> read_statuses(const std::string& path);

/// Whether `path` is an HDF5 file with the groups of a trajectory.
bool holds_trajectory(const std::string& path);

}  // namespace nscdd
