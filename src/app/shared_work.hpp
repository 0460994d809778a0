// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "linalg/threads.hpp"
#include "study/tables/study.hpp"

namespace nscdd::app {

/// The threads and the memory of a run. Results do not depend on them; require_memory refuses work that needs more.
struct Limits {
  Index threads = 0;                ///< 0: the default of the machine
  std::optional<double> gibibytes;  ///< by default 90 % of the available memory

  void declare_threads(Command& command);
  void declare_memory(Command& command);
  void declare(Command& command);  ///< both options

  /// Limits the memory of this rank, one of `processes` on this computer. Throws Error if it holds more already.
  void limit_memory(Index processes = 1) const;
  ThreadLimit limit_threads(const Machine& machine) const;  ///< for the life of the result
  ThreadLimit apply(const Machine& machine) const;          ///< limits both
};

/// Keeps freed memory in the process, in blocks up to 32 MiB (the maximum of the C library). Factors of equal size
/// follow each other, and fresh pages took a seventh of the time at 10^6 grains.
void keep_freed_memory();

/// Returns freed memory, such as that of the whole packing, to the system.
void give_back_freed_memory();

/// Declares --contacts, the contacts of Stage 1.
void declare_contacts(Command& command, Choice<ContactSet>& contacts);

/// Declares --scheme.
void declare_scheme(Command& command, Choice<DecompositionScheme>& scheme);

/// Options of spectra on this machine. Throws Error if they contradict each other, or if it lacks the solver.
SpectralOptions spectra_on(const Machine& machine, SpectralOptions options);

/// Runs work that may fill the cache on rank 0 first, then on the others.
template <class Work>
auto in_turn(const Processes& processes, Work&& work) {
  std::optional<std::invoke_result_t<Work>> result;
  for (const bool turn_of_first : {true, false})
    processes.together([&] {
      if (processes.first() == turn_of_first) result.emplace(work());
      return true;
    });
  return std::move(*result);
}

/// The part of a model that this rank holds. H of the undivided packing keeps its entries only if contacts must be
/// chosen. Throws Error on all ranks if one throws it, or if their models differ.
Model shared_model(const Case& one, const Machine& machine, ContactSet contacts);

/// Throws Error on all ranks unless their fingerprints of the case, `numbers`, are equal.
void require_same(const std::vector<double>& numbers, const std::string& name, const Processes& processes);

/// Requires a single rank for `what`, which needs the whole packing.
void require_one_process(const Machine& machine, std::string_view what);

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

/// Declares --force and --resume.
void declare_reopening(Command& command, Reopening& how);

/// Whether --resume finds a complete table, for all ranks as rank 0 sees it; if so, prints a note. Throws Error without
/// a table, if the table is known to be of other work, or if the HDF5 file is missing, which cannot be made of a table.
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
