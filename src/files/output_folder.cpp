// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/output_folder.hpp"

#include "core/fail.hpp"

#include <filesystem>

namespace nscdd {

namespace fs = std::filesystem;

bool make_folder(const std::string& path, bool force) {
  std::error_code status;
  if (fs::exists(path, status)) {
    if (!fs::is_directory(path, status)) fail("{}: expected a folder, met a file", path);
    if (!force && !fs::is_empty(path, status))
      fail("{}: expected an empty folder or none, met one that holds files; --force writes into it", path);
    return false;
  }
  fs::create_directories(path, status);
  if (status) fail("{}: cannot be made: {}", path, status.message());
  return true;
}

OutputFolder::OutputFolder(std::string path, bool force)
    : path_(std::move(path)), force_(force), made_(make_folder(path_, force_)) {}

OutputFolder::~OutputFolder() {
  if (finished_) return;
  std::error_code ignored;
  for (const std::string& file : written_) fs::remove(file, ignored);
  if (made_ && fs::is_empty(path_, ignored)) fs::remove(path_, ignored);
}

std::string OutputFolder::next(const std::string& name) { return written_.emplace_back((fs::path(path_) / name)); }

}  // namespace nscdd
