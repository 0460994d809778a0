// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/data_files.hpp"

#include <nscdd/core/choice.hpp>
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <cstdlib>
#include <set>

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all.empty() ? "none" : all;
}

}  // namespace

std::vector<fs::path> data_folders() {
  std::vector<fs::path> folders{"."};
  if (const char* named = std::getenv("NSCDD_DATA"); named != nullptr && *named != '\0') folders.emplace_back(named);
  std::error_code status;
  const fs::path program = fs::read_symlink("/proc/self/exe", status);
  if (!status) {
    const fs::path folder = program.parent_path();
    folders.push_back(folder.parent_path().parent_path());        // build/<preset>/nscdd of a source tree
    folders.push_back(folder.parent_path() / "share" / "nscdd");  // bin/nscdd of an installation
  }
  return folders;
}

std::string find_case(const std::string& name) {
  std::error_code ignored;
  if (fs::exists(name, ignored)) return name;
  if (name.find('/') == std::string::npos)
    for (const fs::path& folder : data_folders()) {
      const fs::path path = folder / "cases" / (name + ".toml");
      if (is_file(path)) return path.lexically_normal().string();
    }
  throw Error(
      fmt::format("case '{}': expected a case file (.toml), a packing file (.csv, .h5) or one of the known "
                  "cases ({}), met no such file{}",
                  name, joined(known_cases()), suggestion(name, known_cases())));
}

std::string find_study(const std::string& name) {
  if (is_file(fs::path(name) / "study.toml")) return name;
  if (fs::path(name).filename() == "study.toml" && is_file(name))
    return fs::path(name).has_parent_path() ? fs::path(name).parent_path().string() : ".";
  if (name.find('/') == std::string::npos)
    for (const fs::path& folder : data_folders()) {
      const fs::path path = folder / "studies" / name;
      if (is_file(path / "study.toml")) return path.lexically_normal().string();
    }
  throw Error(
      fmt::format("study '{}': expected a folder with a study.toml or one of the known studies ({}), met none{}", name,
                  joined(known_studies()), suggestion(name, known_studies())));
}

std::vector<std::string> known_cases() {
  std::set<std::string> names;
  std::error_code ignored;
  for (const fs::path& folder : data_folders())
    for (const auto& entry : fs::directory_iterator(folder / "cases", ignored))
      if (entry.path().extension() == ".toml") names.insert(entry.path().stem().string());
  return {names.begin(), names.end()};
}

std::vector<std::string> known_studies() {
  std::set<std::string> names;
  std::error_code ignored;
  for (const fs::path& folder : data_folders())
    for (const auto& entry : fs::directory_iterator(folder / "studies", ignored))
      if (is_file(entry.path() / "study.toml")) names.insert(entry.path().filename().string());
  return {names.begin(), names.end()};
}

}  // namespace nscdd::app
