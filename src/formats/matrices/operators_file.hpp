// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/output_folder.hpp"
#include "study/linear/operators.hpp"

#include <memory>

namespace nscdd {

/// What the manifest says of the whole export.
struct OperatorsHead {
  CaseSummary of_case;
  Index dofs_per_grain = 2;                 ///< d
  std::optional<OperatorParameters> dense;  ///< behind S, P and B; empty where these are left out
};

/// The operators of a case as files of a folder:
///     NAME.mtx        each of them, Matrix Market, with its formula, meaning and unit as remarks
///     operators.h5    all of them. A sparse one is a group with the arrays of SciPy's csc_matrix (`data`, `indices`,
///                     `indptr`, `shape`), a dense one a dataset of two dimensions, numbers a dataset of one.
///                     Attributes `formula`, `meaning`, `unit`, `symmetric`; group `provenance`
///     manifest.toml   the case, its flexibilities, the version of the program, and a table [[operator]] for each
/// The manifest is written last: a folder with a manifest is whole.
class OperatorsFolder {
 public:
  static constexpr const char* manifest_name = "manifest.toml";
  static constexpr const char* hdf5_name = "operators.h5";

  /// Throws Error for a folder that holds files unless `force`.
  OperatorsFolder(const std::string& path, bool force, const std::string& program);
  ~OperatorsFolder();

  /// Writes its file. The first one removes the manifest of an earlier export, which is no longer true.
  void add(const CaseOperator& one);
  /// Writes what is about all of them. Without it the folder takes back what was added.
  void finish(const OperatorsHead& head, const Provenance& provenance);

 private:
  struct Contents;
  OutputFolder folder_;
  std::string program_;  // its name and version, for remarks
  std::unique_ptr<Contents> contents_;
};

}  // namespace nscdd
