// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"
#include "app/interruption.hpp"
#include "study/study.hpp"

#include <string>

namespace nscdd::app {

/// The option --redo, described alike for every verb that has it.
void declare_redo(Command& command, bool& redo);

/// What became of the rows that had not converged or were not certified.
struct Repaired {
  Index rows = 0;           ///< computed again
  Index not_converged = 0;  ///< of these, still not
  Index not_certified = 0;  ///< of these, converged but not certified where that was asked for
  Index left = 0;           ///< not reached before an interruption: they stay as they were

  Repaired& operator+=(const Repaired& more);
};

/// Goes through the finished table of `work` in the file `path` and computes the rows again that did not
/// converge or, where the table has a column `certified`, are not certified. The options are those of `work`;
/// the other rows keep their bytes. The file is replaced when all is done, or when `interruption` asks to
/// stop after the row at hand. A table whose rows have no such columns (links, grains) stays as it is. Throws
/// Error, the file unchanged, where the table is not one of this work.
Repaired repair_table(const StudyTable& work, const std::string& path, Interruption& interruption, LeadIn& lead_in);

/// Brings an HDF5 file of tables up to the rows of the CSV files of the same names in its folder. It goes on
/// with its provenance, to which `command_line` is added as one of the lines of `redone`.
void update_tables(const std::string& hdf5, const std::string& command_line);

/// Tells the user what --redo came to; returns the exit code. `what`: the file or folder repaired.
int explain(const Repaired& repaired, const std::string& what);

}  // namespace nscdd::app
