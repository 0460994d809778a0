// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "study/case.hpp"
#include "study/memory_estimate.hpp"
#include <nscdd/core/table.hpp>
#include <nscdd/study/sweep.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nscdd::app {

/// Names of the cases ("cases") or studies ("studies") of the data folders, sorted, each once. Data folders
/// are the current folder, $NSCDD_DATA, then the source tree or the installation that the program runs from.
std::vector<std::string> known_names(const std::string& kind);

/// A case file: the path given, or cases/NAME.toml of a data folder. Throws Error with the known cases and the
/// nearest name if there is none.
std::string find_case(const std::string& name);

/// A study folder: the path given (or of its study.toml), or studies/NAME of a data folder. Throws in the same way.
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

/// The case with the packing or contact problem that it names, for a verb that writes `outputs` (empty names: not
/// asked for). Where the packing is settled from another case, that one is looked for beside the case file, then among
/// the known cases, and simulated unless the cache has its end. The cache is $NSCDD_CACHE, else $XDG_CACHE_HOME/nscdd,
/// else ~/.cache/nscdd; there is none without a home. Throws Error for whatever cannot be used, for a case that is
/// settled from itself, for one that breaks down, and if an output is a file that the case comes from.
Case resolve_case(const CaseSpec& spec, const std::vector<std::string>& outputs = {});

/// CASE and the options that go with it, the same for every verb that takes a case.
struct CaseOptions {
  std::string name;
  std::string subdomains;
  std::vector<std::string> prescribed;
  std::optional<double> density, tolerance, overlap_tolerance;
  std::vector<std::string> settings;

  void declare(Command& command, bool contact_problems = true);

  /// The case with every option applied (one subdomain unless --subdomains says otherwise), see resolve_case.
  Case resolve(const std::vector<std::string>& outputs) const;
};

/// Which contacts Stage 1 works with, and how spectra are computed.
struct SpectralCommandOptions {
  std::string contacts, solver = "auto";
  SpectralOptions options;  ///< tolerance, certify and eigenvalues as given

  void declare(Command& command, const std::string& default_contacts);  ///< all but certify and eigenvalues
  ContactSet contact_set() const;
  SpectralOptions spectral() const;
};

void declare_threads(Command& command, Index& threads);

/// Memory that a run may take, and its refusal before the run begins.
struct MemoryLimit {
  std::optional<double> gibibytes;  ///< as given; else 90 % of what is available

  void declare(Command& command);

  void require(const MemoryNeed& need) const;  ///< throws Error with both amounts where the need exceeds the limit
};

/// Versions, command line and the resolved cases, for a result file. Nothing in it changes from run to run.
Provenance provenance(const Context& context, const std::vector<Case>& cases);

}  // namespace nscdd::app
