// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/linear/operators.hpp"

namespace nscdd {

namespace hdf5 {
class File;
}

/// The head of the manifest.
struct OperatorsHead {
  CaseSummary of_case;
  Index dofs_per_grain = 2;                 ///< d
  std::optional<OperatorParameters> dense;  ///< of S, P and B; empty without them
};

/// The operators of a case as files of a folder (docs/formats.md): NAME.mtx for each (Matrix Market), operators.h5 with
/// all of them, and manifest.toml. The manifest is written last: a folder with a manifest is complete.
class OperatorsFolder {
 public:
  static constexpr const char* manifest_name = "manifest.toml";
  static constexpr const char* hdf5_name = "operators.h5";

  /// Throws Error as `make_folder`. With `force`, files of an earlier run stay unless written again.
  OperatorsFolder(std::string path, bool force, const std::string& program);
  /// Without `finish`, removes the files that were written, and the folder if it is new.
  ~OperatorsFolder();
  OperatorsFolder(const OperatorsFolder&) = delete;
  OperatorsFolder& operator=(const OperatorsFolder&) = delete;

  /// Writes the file of an operator. The first call removes the manifest of an earlier export.
  void add(const CaseOperator& one);
  /// Writes operators.h5 and the manifest, and keeps the files.
  void finish(const OperatorsHead& head, const Provenance& provenance);

 private:
  std::string next(const std::string& name);  // the path of the next file
  std::string path_;
  bool force_, made_, finished_ = false;
  std::vector<std::string> written_;
  std::string program_;  // name and version, for remarks
  std::unique_ptr<hdf5::File> hdf5_;
  std::string tables_;  // of the manifest
};

}  // namespace nscdd
