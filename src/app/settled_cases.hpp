// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace nscdd::app {

/// The case with the packing or contact problem that it names. Where the packing is settled from another
/// case, that one is looked for beside the case file, then among the known cases, and simulated unless the
/// cache has its end. Throws Error for whatever cannot be used, for a case that is settled from itself, and
/// for one that breaks down.
Case resolve_settled(const CaseSpec& spec);

/// Every file that a case comes from: its case file, its packing or contact problem, and those of the case it
/// is settled from, at any depth.
std::vector<std::filesystem::path> files_behind(const CaseSpec& spec);

/// Throws Error if an output (an empty name is none) is one of these files, under whatever name. The input
/// would be lost, and --force does not ask for that.
void require_no_input(const std::vector<std::string>& outputs, const std::vector<std::filesystem::path>& inputs);

/// Folder of the cache: $NSCDD_CACHE, else $XDG_CACHE_HOME/nscdd, else ~/.cache/nscdd; none without a home.
std::optional<std::filesystem::path> cache_folder();

}  // namespace nscdd::app
