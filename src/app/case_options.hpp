// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"
#include "study/case.hpp"

#include <optional>
#include <string>
#include <vector>

namespace nscdd::app {

/// What is behind a name: a case file, a known case, or a packing file or contact problem with everything
/// else as by default.
CaseSpec find_spec(const std::string& name);

/// The case that a verb works on. `outputs` are the files that the verb writes (empty names: not asked for).
/// Throws Error if one of them is a file that the case comes from, and for whatever cannot be used.
Case resolve_case(const CaseSpec& spec, const std::vector<std::string>& outputs);

/// Sets parameters of a case from texts KEY=VALUE.
void apply_settings(CaseSpec& spec, const std::vector<std::string>& settings);

/// CASE and the options that go with it, the same for every verb that takes a case.
struct CaseOptions {
  std::string name;
  std::string subdomains;
  std::vector<std::string> prescribed;
  std::optional<double> density;
  std::optional<double> tolerance, overlap_tolerance;
  std::vector<std::string> settings;

  void declare(Command& command);

  /// The case with every option applied: a case file, a known case, or a packing file (one subdomain unless
  /// --subdomains says otherwise), none of whose files is one of `outputs`. Throws Error for whatever
  /// cannot be used.
  Case resolve(const std::vector<std::string>& outputs) const;

 private:
  void apply(CaseSpec& spec) const;
};

}  // namespace nscdd::app
