// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "study/tables/study.hpp"

namespace nscdd::app {

/// A table that several processes work on. Rank 0 holds it; rows of other ranks are dropped.
class SharedTable {
 public:
  /// Throws Error in all processes if the first cannot open it.
  SharedTable(const Machine& machine, const std::string& path, const TableWork& work, Reopening how);
  ResumableTable& operator*() { return *table_; }
  ResumableTable* operator->() { return &*table_; }
  Index kept() const { return kept_; }           ///< rows that existed before this run, for all processes
  void forget() const { remove_record(path_); }  ///< of a finished table, see remove_record

 private:
  std::string path_;
  std::optional<ResumableTable> table_;
  Index kept_ = 0;
};

/// The option --resume, described alike for every verb that has it.
void declare_resume(Command& command, bool& resume);

/// Whether --resume finds a complete table; if so, prints a note. Throws Error if an HDF5 file is still missing,
/// because nothing records the work that the table came from.
bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how);
/// The same for all ranks, as found by rank 0.
bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how, const Machine& machine);

/// The bytes that OutputFile keeps of an output that is written in one piece at the end: none, because an interrupted
/// run leaves it empty.
inline std::optional<std::uintmax_t> kept_of_whole(Reopening how) {
  return how.resume ? std::optional<std::uintmax_t>(0) : std::nullopt;
}

/// Closes an interrupted table, tells the user how to go on, and returns the exit code.
int leave(ResumableTable& table, const std::string& path);

/// Throws Error where the finished table in the file `path` has other columns, another number of rows or other
/// parameters in a row than `work`, as far as these are known before it is computed.
void require_rows_of(const StudyTable& work, const std::string& path);

}  // namespace nscdd::app
