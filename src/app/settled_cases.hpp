// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/case.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace nscdd::app {

/// A case from a file. Where its packing is settled from another case, that one is looked for beside the
/// file, then among the known cases, and simulated unless the cache has its end. Throws Error for whatever
/// cannot be used, for a case that is settled from itself, and for one that breaks down.
Case read_case_file(const std::string& path);

/// The same without settling anything, for a case that is judged by its text or will not be used: two grains
/// stand for the packing.
Case read_unsettled_case_file(const std::string& path);

/// Folder of the cache: $NSCDD_CACHE, else $XDG_CACHE_HOME/nscdd, else ~/.cache/nscdd; none without a home.
std::optional<std::filesystem::path> cache_folder();

}  // namespace nscdd::app
