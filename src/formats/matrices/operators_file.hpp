// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/output_file.hpp"
#include "study/linear/operators.hpp"

#include <deque>

namespace nscdd {

namespace hdf5 {
class File;
}

/// The operators of a case as files of a folder (docs/formats.md): NAME.mtx for each (Matrix Market), operators.h5 with
/// all of them, and manifest.toml. The manifest is written last: a folder with a manifest is complete.
class OperatorsFolder {
 public:
  static constexpr const char* manifest_name = "manifest.toml";
  static constexpr const char* hdf5_name = "operators.h5";

  /// Throws Error as `make_folder`. With `force`, files of an earlier export stay unless `finish` replaces them.
  OperatorsFolder(std::string path, bool force, const std::string& program);
  /// Without `finish`, removes what was written, and the folder if it is new.
  ~OperatorsFolder();
  OperatorsFolder(const OperatorsFolder&) = delete;
  OperatorsFolder& operator=(const OperatorsFolder&) = delete;

  /// Writes the file of an operator under its partial name.
  void add(const CaseOperator& one);
  /// Writes operators.h5 and the manifest, and gives all files their names.
  void finish(const CaseSummary& of_case, Index dofs_per_grain, const OperatorParameters& parameters,
              const Provenance& provenance);

 private:
  OutputFile& open(const std::string& name);
  std::filesystem::path path_;
  bool force_, made_;
  std::deque<OutputFile> files_;  // those of the operators, operators.h5 and the manifest
  std::string program_;           // name and version, for remarks
  std::unique_ptr<hdf5::File> hdf5_;
  std::string tables_;  // of the manifest
};

}  // namespace nscdd
