// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case/case.hpp"

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

/// Every file that a case comes from: its case file, its packing or contact problem, and those of the case it
/// is settled from, at any depth.
std::vector<std::filesystem::path> files_behind(const CaseSpec& spec);

/// Throws Error if an output (an empty name is none) is one of these files, also through a link. --force does not
/// permit it either: the input would be lost.
void require_no_input(const std::vector<std::string>& outputs, const std::vector<std::filesystem::path>& inputs);

/// The case with the packing or contact problem that it names, for a verb that writes `outputs` (empty names: not
/// asked for). If the packing is settled from another case, this case is searched for in the folder of the case file,
/// then among the known cases, and simulated unless the cache has its end. The cache is $NSCDD_CACHE, else
/// $XDG_CACHE_HOME/nscdd, else ~/.cache/nscdd; without a home there is none. Throws Error for input that cannot be
/// used, for a case that is settled from itself, for one that breaks down, and if an output is an input of the case.
Case resolve_case(const CaseSpec& spec, const std::vector<std::string>& outputs = {});

}  // namespace nscdd::app
