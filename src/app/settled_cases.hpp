// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/case.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace nscdd::app {

/// A case from a file. Where its packing is settled from another case, that one is looked for beside the
/// file, then among the known cases, and simulated unless the cache has its end. Throws Error for whatever
/// cannot be used, for a case that is settled from itself, and for one that breaks down.
Case read_case_file(const std::string& path);

/// The same without settling anything, for a case that is judged by its text or will not be used: two grains
/// stand for the packing.
Case read_unsettled_case_file(const std::string& path);

/// Every file that a case read from `path` (a case file, a packing file or a contact problem) comes from:
/// that one, its packing or contact problem, and those of the case it is settled from, at any depth.
std::vector<std::filesystem::path> files_behind(const Case& one, const std::string& path);

/// Throws Error where an output (empty: none) is one of these files, under whatever name: it would be lost,
/// and --force does not ask for that.
void require_no_input(const std::vector<std::string>& outputs,
                      const std::vector<std::filesystem::path>& inputs);

/// Folder of the cache: $NSCDD_CACHE, else $XDG_CACHE_HOME/nscdd, else ~/.cache/nscdd; none without a home.
std::optional<std::filesystem::path> cache_folder();

}  // namespace nscdd::app
