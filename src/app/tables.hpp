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

/// A table with a row for each process: what it has done, see WorkCount, and what it took. Rank 0 writes it.
class CountsTable {
 public:
  static void declare(Command& command, std::string& path);

  /// Nothing is written where `path` is empty. Throws Error in all processes if the first cannot open it.
  CountsTable(const std::string& path, bool force, const Machine& machine);
  /// All processes together.
  void finish();

 private:
  Processes processes_;
  bool wanted_;
  double begun_ = seconds();
  std::optional<CsvWriter> csv_;
};

/// The option --resume, described alike for every verb that has it.
void declare_resume(Command& command, bool& resume);

/// Whether --resume finds a complete table, for all ranks as found by rank 0; if so, prints a note. Throws Error if an
/// HDF5 file is still missing, because nothing records the work that the table came from.
bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how, const Machine& machine);

/// The bytes that OutputFile keeps of an output that is written in one piece at the end: none, because an interrupted
/// run leaves it empty.
inline std::optional<std::uintmax_t> kept_of_whole(Reopening how) {
  return how.resume ? std::optional<std::uintmax_t>(0) : std::nullopt;
}

/// A table as notes name it.
inline std::string name_of_output(const std::string& path) { return path == "-" ? "standard output" : path; }

/// Closes an interrupted table, tells the user how to go on, and returns the exit code.
int leave(ResumableTable& table, const std::string& path);

}  // namespace nscdd::app
