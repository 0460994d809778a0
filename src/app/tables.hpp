// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "study/tables/study.hpp"

namespace nscdd::app {

/// A table of several ranks. Rank 0 writes it; rows of other ranks are dropped.
class SharedTable {
 public:
  /// Throws Error on all ranks if rank 0 cannot open it.
  SharedTable(const Machine& machine, const std::string& path, const TableWork& work, Reopening how);
  ResumableTable& operator*() { return *table_; }
  ResumableTable* operator->() { return &*table_; }
  Index kept() const { return kept_; }           ///< rows that existed before this run, on all ranks
  void forget() const { remove_record(path_); }  ///< once the table is finished

 private:
  std::string path_;
  std::optional<ResumableTable> table_;
  Index kept_ = 0;
};

/// The table of --counts: a row per rank with its WorkCount, time and memory. Rank 0 writes it.
class CountsTable {
 public:
  static void declare(Command& command, std::string& path);

  /// Writes nothing if `path` is empty. Throws Error on all ranks if rank 0 cannot open it.
  CountsTable(const std::string& path, bool force, const Machine& machine);
  void finish();  ///< collective

 private:
  Processes processes_;
  bool wanted_;
  double begun_ = seconds();
  std::optional<CsvWriter> csv_;
};

/// Declares --resume.
void declare_resume(Command& command, bool& resume);

/// Whether --resume finds a complete table, for all ranks as rank 0 sees it; if so, prints a note. Throws Error if the
/// table is known to be of other work, or if the HDF5 file is missing, which cannot be made of a table.
bool nothing_to_resume(const std::string& csv, const std::string& hdf5, const TableWork& work, Reopening how,
                       const Machine& machine);

/// `kept_bytes` of OutputFile for an output written at the end: 0, because an interrupted run leaves it empty.
inline std::optional<std::uintmax_t> kept_of_whole(Reopening how) {
  return how.resume ? std::optional<std::uintmax_t>(0) : std::nullopt;
}

/// The name of an output in notes.
inline std::string name_of_output(const std::string& path) { return path == "-" ? "standard output" : path; }

/// Closes an interrupted table, notes how to continue, and returns the exit code.
int leave(ResumableTable& table, const std::string& path);

}  // namespace nscdd::app
