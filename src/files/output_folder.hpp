// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace nscdd {

/// Creates a folder with its parents; returns whether it is new. Throws Error if `path` is a file, if the system fails,
/// and for a folder with files unless `force`.
bool make_folder(const std::string& path, bool force);

/// Output folder of files that belong together. Each is complete when it appears (see OutputFile). A failing run
/// removes the files it wrote, and the folder if it created that.
class OutputFolder {
 public:
  /// See `make_folder`. With `force`, files of an earlier run stay unless written again.
  OutputFolder(std::string path, bool force);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Path of a file of that name, about to be written.
  std::string next(const std::string& name);
  bool force() const { return force_; }
  const std::string& path() const { return path_; }
  void finish() { finished_ = true; }  ///< keeps all files

 private:
  std::string path_;
  bool force_, made_, finished_ = false;
  std::vector<std::string> written_;
};

}  // namespace nscdd
