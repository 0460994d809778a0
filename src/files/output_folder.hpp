// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace nscdd {

/// Makes the folder, with those that it lies in; returns whether there was none. Throws Error if `path` is a file, if
/// the system refuses, and for a folder that holds files unless `force`.
bool make_folder(const std::string& path, bool force);

/// A folder of files that belong together. Each is whole when it appears (see OutputFile). A run that fails takes back
/// what it has written, and the folder if it made that.
class OutputFolder {
 public:
  /// See `make_folder`. With `force` files of an earlier run that are not written again stay.
  OutputFolder(std::string path, bool force);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where a file of that name goes, which is about to be written.
  std::string next(const std::string& name);
  bool force() const { return force_; }
  const std::string& path() const { return path_; }
  void finish() { finished_ = true; }  ///< all of them are there, and stay

 private:
  std::string path_;
  bool force_, made_, finished_ = false;
  std::vector<std::string> written_;
};

}  // namespace nscdd
