// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "study/case.hpp"
#include <nscdd/core/table.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace nscdd::app {

/// Names of the cases ("cases") or studies ("studies") of the data folders, sorted, each once. Data folders
/// are the current folder, $NSCDD_DATA, then the source tree or the installation that the program runs from.
std::vector<std::string> known_names(const std::string& kind);

/// A case file: the path given, or cases/NAME.toml of a data folder. Throws Error with the known cases and the
/// nearest name if there is none.
std::string find_case(const std::string& name);

/// A study folder: the path given (or of its study.toml), or studies/NAME of a data folder. Throws in the
/// same way.
std::string find_study(const std::string& name);

/// What is behind a name: a case file, a known case, or a packing file or contact problem with everything
/// else as by default.
CaseSpec find_spec(const std::string& name);

/// Sets parameters of a case from texts KEY=VALUE.
void apply_settings(CaseSpec& spec, const std::vector<std::string>& settings);

/// Every file that a case comes from: its case file, its packing or contact problem, and those of the case it
/// is settled from, at any depth.
std::vector<std::filesystem::path> files_behind(const CaseSpec& spec);

/// Throws Error if an output (an empty name is none) is one of these files, under whatever name. The input
/// would be lost, and --force does not ask for that.
void require_no_input(const std::vector<std::string>& outputs, const std::vector<std::filesystem::path>& inputs);

/// The case with the packing or contact problem that it names. Where the packing is settled from another
/// case, that one is looked for beside the case file, then among the known cases, and simulated unless the
/// cache has its end. The cache is $NSCDD_CACHE, else $XDG_CACHE_HOME/nscdd, else ~/.cache/nscdd; there is
/// none without a home. Throws Error for whatever cannot be used, for a case that is settled from itself, and
/// for one that breaks down.
Case resolve_settled(const CaseSpec& spec);

/// The same for a verb that writes `outputs` (empty names: not asked for). Throws Error if one of them is a
/// file that the case comes from.
Case resolve_case(const CaseSpec& spec, const std::vector<std::string>& outputs);

/// CASE and the options that go with it, the same for every verb that takes a case.
struct CaseOptions {
  std::string name;
  std::string subdomains;
  std::vector<std::string> prescribed;
  std::optional<double> density, tolerance, overlap_tolerance;
  std::vector<std::string> settings;

  void declare(Command& command);

  /// The case with every option applied (one subdomain unless --subdomains says otherwise), see resolve_case.
  Case resolve(const std::vector<std::string>& outputs) const;
};

/// Versions, command line and the resolved cases, for a result file. Nothing in it changes from run to run.
Provenance provenance(const Context& context, const std::vector<Case>& cases);

}  // namespace nscdd::app
