// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case/case.hpp"

#include <filesystem>

namespace nscdd::app {

/// Sorted names of the `kind` "cases" or "studies" in the data folders: the current folder, $NSCDD_DATA, then the
/// source tree or the installation of the program.
std::vector<std::string> known_names(const std::string& kind);

/// A case file: the path `name`, or cases/NAME.toml of a data folder. Else throws Error with known and nearest names.
std::string find_case(const std::string& name);

/// A study folder: the path of it or of its study.toml, or studies/NAME of a data folder. Throws as find_case.
std::string find_study(const std::string& name);

/// All input files of a case: its case file, its packing or contact problem, and those of the case it is settled from.
std::vector<std::filesystem::path> files_behind(const CaseSpec& spec);

/// Throws Error if an output (empty names aside) is one of the inputs, also through a link. --force does not permit it.
void require_no_input(const std::vector<std::string>& outputs, const std::vector<std::filesystem::path>& inputs);

/// The case with its packing or contact problem, for a verb that writes `outputs` (empty names aside). A packing that
/// is settled from another case is read from the cache, or that case is simulated; its file is searched for in the
/// folder of the case file, then among the known cases. The cache is $NSCDD_CACHE, $XDG_CACHE_HOME/nscdd or
/// ~/.cache/nscdd, if there is a home. Throws Error for unusable input, for a case that is settled from itself or
/// breaks down, and for an output that is an input of the case.
Case resolve_case(const CaseSpec& spec, const std::vector<std::string>& outputs = {});

}  // namespace nscdd::app
