// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace nscdd::app {

/// Folders that may hold cases/ and studies/, in the order searched: the current folder, $NSCDD_DATA, then
/// the source tree or the installation that the program runs from.
std::vector<std::filesystem::path> data_folders();

/// A case file: the path given, or cases/NAME.toml of a data folder. Throws Error with the known
/// cases and the nearest name if there is none.
std::string find_case(const std::string& name);

/// A study folder: the path given (or of its study.toml), or studies/NAME of a data folder. Throws in the
/// same way.
std::string find_study(const std::string& name);

/// Names of what the data folders hold, sorted, each once.
std::vector<std::string> known_cases();
std::vector<std::string> known_studies();

}  // namespace nscdd::app
