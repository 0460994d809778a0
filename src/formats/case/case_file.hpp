// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case/case.hpp"
#include "study/tables/study.hpp"

namespace nscdd {

/// What a case file says, from its text alone. Strict: an unknown key, a wrong type, a missing section or a
/// value out of its bounds throws Error "file:line: key: expected ..., met ...". So does a value without effect, but in
/// the case of a trajectory: there the program wrote the defaults, perhaps those of an earlier version.
CaseSpec parse_case(std::string_view text, const std::string& file, bool of_trajectory = false);

/// What a case file says, named by its stem.
CaseSpec read_case(const std::string& path);

/// The case of any file or folder of the command line: a case file (.toml), a packing, a contact problem, or a folder
/// DATBOX of LMGC90, whose laws and boundaries are read only if `moving`. Throws Error for a name with another ending,
/// and as the readers of these files.
CaseSpec spec_of_file(const std::string& path, bool moving = false);

/// The case with the packing or contact problem of the file that it names, which lies beside the case file. Throws
/// Error "file:line: packing.file: ..." for a file that cannot be used, and for a packing that is to be settled first.
Case resolve(CaseSpec spec);

/// Finds the case named in a study file ("disks4", or a path) and reads its case file.
using CaseFinder = std::function<CaseSpec(const std::string& name)>;

/// A study from the text of its file, as strict. Its cases are not resolved: settling takes long, and not all are run.
Study parse_study(std::string_view text, const std::string& file, const CaseFinder& find);

}  // namespace nscdd
