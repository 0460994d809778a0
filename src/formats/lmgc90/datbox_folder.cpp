// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/csv.hpp"
#include "formats/lmgc90/datbox.hpp"

#include <filesystem>

namespace nscdd {
namespace {

std::filesystem::path datbox_folder(const std::string& path) {
  const std::filesystem::path folder(path);
  std::error_code ignored;
  return std::filesystem::is_regular_file(folder / "BODIES.DAT", ignored) ? folder : folder / "DATBOX";
}

}  // namespace

bool holds_datbox(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) &&
         std::filesystem::is_regular_file(datbox_folder(path) / "BODIES.DAT", ignored);
}

std::vector<std::string> datbox_files(const std::string& path) {
  std::vector<std::string> files;
  for (const char* name : {"BODIES.DAT", "BULK_BEHAV.DAT", "TACT_BEHAV.DAT", "DRV_DOF.DAT", "DOF.INI"}) {
    const std::filesystem::path file = datbox_folder(path) / name;
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) files.push_back(file.string());
  }
  return files;
}

Datbox read_datbox(const std::string& path) {
  const std::filesystem::path folder = datbox_folder(path);
  const auto text = [&](const char* name, bool required) {
    const std::filesystem::path file = folder / name;
    std::error_code ignored;
    return required || std::filesystem::exists(file, ignored) ? read_text(file.string()) : std::string();
  };
  return parse_datbox({text("BODIES.DAT", true), text("BULK_BEHAV.DAT", true), text("TACT_BEHAV.DAT", false),
                       text("DRV_DOF.DAT", false), text("DOF.INI", false),
                       [&](const std::string& name) { return text(name.c_str(), true); }},
                      folder.string());
}

}  // namespace nscdd
