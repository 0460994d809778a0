// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "study/case/case.hpp"
#include "study/linear/memory_estimate.hpp"
#include <nscdd/study/sweep.hpp>

#include <filesystem>

namespace nscdd::app {

/// Names of the cases ("cases") or studies ("studies") of the data folders, sorted, each once. Data folders
/// are the current folder, $NSCDD_DATA, then the source tree or the installation that the program runs from.
std::vector<std::string> known_names(const std::string& kind);

/// A case file: the path given, or cases/NAME.toml of a data folder. Throws Error with the known cases and the
/// nearest name if there is none.
std::string find_case(const std::string& name);

/// A study folder: the path given (or of its study.toml), or studies/NAME of a data folder. Throws in the same way.
std::string find_study(const std::string& name);

/// What is behind a name: a case file, a known case, or a packing file or contact problem with everything
/// else as by default.
CaseSpec find_spec(const std::string& name);

/// Sets parameters of a case from texts KEY=VALUE.
void apply_settings(CaseSpec& spec, const std::vector<std::string>& settings);

/// Every file that a case comes from: its case file, its packing or contact problem, and those of the case it
/// is settled from, at any depth.
std::vector<std::filesystem::path> files_behind(const CaseSpec& spec);

/// Throws Error if an output (an empty name is none) is one of these files, under whatever name. The input
/// would be lost, and --force does not ask for that.
void require_no_input(const std::vector<std::string>& outputs, const std::vector<std::filesystem::path>& inputs);

/// The case with the packing or contact problem that it names, for a verb that writes `outputs` (empty names: not
/// asked for). Where the packing is settled from another case, that one is looked for beside the case file, then among
/// the known cases, and simulated unless the cache has its end. The cache is $NSCDD_CACHE, else $XDG_CACHE_HOME/nscdd,
/// else ~/.cache/nscdd; there is none without a home. Throws Error for whatever cannot be used, for a case that is
/// settled from itself, for one that breaks down, and if an output is a file that the case comes from.
Case resolve_case(const CaseSpec& spec, const std::vector<std::string>& outputs = {});

/// Cuts the case as --subdomains says, in place of its [partition].
void set_partition(CaseSpec& spec, const std::string& subdomains);

/// CASE and the options that go with it, the same for every verb that takes a case.
struct CaseOptions {
  std::string name;
  std::string subdomains;
  std::vector<std::string> prescribed;
  std::optional<double> density, tolerance, overlap_tolerance;
  std::vector<std::string> settings;

  void declare(Command& command, bool contact_problems = true);
  void declare_options(Command& command);  ///< all but CASE

  /// The case with every option applied (one subdomain unless --subdomains says otherwise), see resolve_case.
  Case resolve(const std::vector<std::string>& outputs) const;
};

/// Which contacts Stage 1 works with, and how spectra are computed.
struct SpectralCommandOptions {
  std::string contacts, solver = "auto";
  SpectralOptions options;  ///< tolerance, certify and eigenvalues as given

  void declare(Command& command, const std::string& default_contacts);  ///< all but certify and eigenvalues
  void declare_solver(Command& command);                                ///< the same without the contacts
  ContactSet contact_set() const;
  SpectralOptions spectral() const;
};

void declare_threads(Command& command, Index& threads);
/// Threads at the most: as asked for, or where nothing is said as the machine has it.
inline Index threads_of(Index asked, const Machine& machine) { return asked > 0 ? asked : machine.threads; }

/// Gives memory that is free again back to the system: what a whole packing took would stay with the process, see
/// keep_freed_memory.
void give_back_freed_memory();

/// Work that may leave something in the cache: the first process does it before the others.
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

/// The model of a case as this process has it; H of the undivided packing keeps its entries only where contacts must be
/// chosen. `check` is called with all subdomains before, which have no matrices yet. Throws Error in all processes if
/// one throws it, or if they do not have the same.
Model shared_model(const Case& one, const Machine& machine, ContactSet contacts,
                   const std::function<void(const Model& whole)>& check);

/// Throws Error in all processes unless they have the same numbers, which tell one case from another.
void require_same(const std::vector<double>& numbers, const std::string& name, const Processes& processes);

/// Throws Error for what needs the whole packing where several processes share it.
void require_one_process(const Machine& machine, std::string_view what);
/// The same of a solver of spectra that solves with X_eta.
void require_shared(const SpectralOptions& spectral, const Machine& machine);

/// Memory that a run may take, and its refusal before the run begins.
struct MemoryLimit {
  std::optional<double> gibibytes;  ///< as given; else 90 % of what is available

  void declare(Command& command);

  void require(const MemoryNeed& need) const;  ///< throws Error with both amounts where the need exceeds the limit
  /// The same where processes share the work: what those on one computer need of it. `need`: of all.
  void require(MemoryNeed need, const Machine& machine) const;
};

/// A table that several processes work on. The first of them has it; what the others write is lost.
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

/// Whether --resume meets a table that is complete, of which a note then tells the user. Throws Error if an
/// HDF5 file is still asked for, because nothing tells what work the table came from.
bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how);
/// The same for all processes, as the first has it.
bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how, const Machine& machine);

/// The bytes that OutputFile keeps of an output that is written in one piece at the end: none, because what
/// an interrupted run left of it is empty.
inline std::optional<std::uintmax_t> kept_of_whole(Reopening how) {
  return how.resume ? std::optional<std::uintmax_t>(0) : std::nullopt;
}

/// Closes an interrupted table, tells the user how to go on, and returns the exit code.
int leave(ResumableTable& table, const std::string& path);

/// Throws Error where the finished table in the file `path` has other columns, another number of rows or other
/// parameters in a row than `work`, as far as these are known before it is computed.
void require_rows_of(const StudyTable& work, const std::string& path);

/// Versions, command line and the resolved cases, for a result file. Nothing in it changes from run to run.
Provenance provenance(const Context& context, const std::vector<Case>& cases);

}  // namespace nscdd::app
