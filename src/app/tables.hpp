// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "files/resumable_table.hpp"
#include "study/study.hpp"

#include <string>

namespace nscdd::app {

/// The options --resume and --redo, described alike for every verb that has them.
void declare_resume(Command& command, bool& resume);
void declare_redo(Command& command, bool& redo);

/// Whether --resume meets a table that is complete, of which a note then tells the user. Throws Error if an
/// HDF5 file is still asked for, because nothing tells what work the table came from.
bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how);

/// The bytes that OutputFile keeps of an output that is written in one piece at the end: none, because what
/// an interrupted run left of it is empty.
inline std::optional<std::uintmax_t> kept_of_whole(Reopening how) {
  return how.resume ? std::optional<std::uintmax_t>(0) : std::nullopt;
}

/// Closes an interrupted table, tells the user how to go on, and returns the exit code.
int leave(ResumableTable& table, const std::string& path);

/// What became of the rows that had not converged or were not certified.
struct Repaired {
  Index rows = 0;           ///< computed again
  Index not_converged = 0;  ///< of these, still not
  Index not_certified = 0;  ///< of these, converged but not certified where that was asked for
  Index left = 0;           ///< not reached before an interruption: they stay as they were
};

/// Goes through the finished table of `work` in the file `path` and computes the rows again that did not
/// converge or, where the table has a column `certified`, are not certified. What became of them is added to
/// `repaired`. The options are those of `work`; the other rows keep their bytes. The file is replaced when all
/// is done, or when `interruption` asks to stop after the row at hand. A table whose rows have no such columns
/// (links, grains) stays as it is. Throws Error, the file unchanged, where the table is not one of this work.
void repair_table(const StudyTable& work, const std::string& path, Interruption& interruption, LeadIn& lead_in,
                  Repaired& repaired);

/// Throws Error where the finished table in the file `path` has other columns, another number of rows or other
/// parameters in a row than `work`, as far as these are known before it is computed.
void require_rows_of(const StudyTable& work, const std::string& path);

/// Brings an HDF5 file of tables up to the rows of the CSV files of the same names in its folder. It goes on
/// with its provenance, to which `command_line` is added as one of the lines of `redone`.
void update_tables(const std::string& hdf5, const std::string& command_line);

/// Tells the user what --redo came to; returns the exit code. `what`: the file or folder repaired.
int explain(const Repaired& repaired, const std::string& what);

/// Repairs one table alone and explains; returns the exit code.
int redo_table(const StudyTable& work, const std::string& path);

}  // namespace nscdd::app
