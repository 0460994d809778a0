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

/// Throws Error if an output (an empty name is none) is one of these files, under whatever name. The input
/// would be lost, and --force does not ask for that.
void require_no_input(const std::vector<std::string>& outputs, const std::vector<std::filesystem::path>& inputs);

/// The case with the packing or contact problem that it names, for a verb that writes `outputs` (empty names: not
/// asked for). Where the packing is settled from another case, that one is looked for beside the case file, then among
/// the known cases, and simulated unless the cache has its end. The cache is $NSCDD_CACHE, else $XDG_CACHE_HOME/nscdd,
/// else ~/.cache/nscdd; there is none without a home. Throws Error for whatever cannot be used, for a case that is
/// settled from itself, for one that breaks down, and if an output is a file that the case comes from.
Case resolve_case(const CaseSpec& spec, const std::vector<std::string>& outputs = {});

}  // namespace nscdd::app
